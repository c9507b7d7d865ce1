#include <stroma/shapes/ball.h>
#include <stroma/shapes/box.h>
#include <stroma/shapes/faceted.h>
#include <stroma/shapes/ring.h>
#include <stroma/shapes/table.h>

namespace Stroma::Shapes
{
  template <>
  std::vector<std::pair<std::string, Read<2>>>
  table<2>()
  {
    return {{"box", Box<2>::read},
            {"ball", Ball<2>::read},
            {"ring", Ring::read},
            {"quadrilateral", read_quadrilateral},
            {"polygon", read_polygon}};
  }

  template <>
  std::vector<std::pair<std::string, Read<3>>>
  table<3>()
  {
    return {{"box", Box<3>::read}, {"ball", Ball<3>::read}, {"surface", read_surface}};
  }

  template <int dim>
  dealii::Point<dim>
  read_point(Parameters &p, const std::string &entry, const std::string &meaning, const double start)
  {
    std::vector<double> values(dim, start);
    p.add(entry, values, meaning, "m", Range::any(), dim);
    dealii::Point<dim> point;
    std::copy(values.begin(), values.end(), point.begin_raw());
    return point;
  }

  template dealii::Point<2> read_point<2>(Parameters &, const std::string &, const std::string &, double);
  template dealii::Point<3> read_point<3>(Parameters &, const std::string &, const std::string &, double);
} // namespace Stroma::Shapes
