#include <stroma/base/text.h>
#include <stroma/processes/degradation.h>

#include <cmath>

namespace Stroma::Processes
{
  template <int dim>
  void
  Degradation<dim>::add(Parameters &p, const std::string &its_name, const std::vector<Migration<dim>> &migrations)
  {
    name  = its_name;
    where = p.where_section();
    std::vector<std::pair<std::string, unsigned int>> choices; // by name of the migration
    for (unsigned int m = 0; m < migrations.size(); ++m)
      choices.emplace_back(migrations[m].name, m);
    if (choices.empty())
      throw UserError(where, "degradation '" + name +
                               "' is in front of a body that propels itself, but the scene has none; " +
                               "add one to section Migration");
    unsigned int of_migration = 0;
    p.add_choice<unsigned int>("Migration", of_migration, "of the body that degrades what is in front of it", choices);
    migration = migrations[of_migration];
    body      = migration.body;
    law       = degradation_law(p);
    p.add("Width", width, "from the body's surface up to which it degrades, l_degr", "m", Range::positive());
    p.add("Angle", angle, "from the direction of its force within which it does, to either side, theta_degr [degrees]",
          "", {0., 180., true, false});
    initial_width = width;
    p.add("Initial width", initial_width,
          "around the body in which everything is a fluid at the start; default: 'Width'", "m", Range::non_negative());
    angle *= std::acos(-1.) / 180.;
  }

  template <int dim>
  double
  Degradation<dim>::at_start(const Shapes::Shape<dim> &shape, const dealii::Point<dim> &X) const
  {
    return shape.distance(X) < initial_width ? 0. : 1.;
  }

  template <int dim>
  bool
  Degradation<dim>::is_in_front(const dealii::Tensor<1, dim> &arm, const double t) const
  {
    return arm * migration.direction(t) >= std::cos(angle) * arm.norm();
  }

  template <int dim>
  double
  Degradation<dim>::after(const double f, const Shapes::Shape<dim> &shape, const Rigid::Pose<dim> &pose,
                          const dealii::Point<dim> &x, const double t, const double dt) const
  {
    if (f == 0.)
      return 0.;
    const auto   arm = x - pose.pivot - pose.translation;
    const double d   = shape.distance(pose.pivot + transpose(Rigid::rotation_matrix<dim>(pose.rotation)) * arm);
    return d < width && is_in_front(arm, t) ? law->after(f, d, dt) : f;
  }

  template class Degradation<2>;
  template class Degradation<3>;
} // namespace Stroma::Processes
