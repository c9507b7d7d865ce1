#include <stroma/fem/remote_cells.h>

#include <algorithm>

namespace Stroma::Fem
{
  namespace
  {
    /// Numbers that are sent at once, for a place.
    constexpr unsigned int n_at_once = 8;
  } // namespace

  template <int dim>
  RemoteCells<dim>::RemoteCells(const Mesh<dim> &mesh, const std::vector<Output::Place> &X)
  {
    std::vector<dealii::Point<dim>> points;
    points.reserve(X.size());
    for (const auto &place : X)
      points.push_back(Output::point_of<dim>(place));
    remote.reinit(points, mesh.triangulation, mesh.mapping());

    std::vector<double> unused, buffer;
    remote.template evaluate_and_process<double>(unused, buffer, [&](const auto &, const auto &data) {
      const auto &first = data.reference_point_ptrs;
      for (unsigned int c = 0; c < data.cells.size(); ++c)
        asked[Cell(&mesh.triangulation, data.cells[c].first, data.cells[c].second)] = {
          {data.reference_point_values.begin() + first[c], data.reference_point_values.begin() + first[c + 1]},
          first[c]};
      n = data.reference_point_values.size();
    });
  }

  template <int dim>
  const typename RemoteCells<dim>::Asked *
  RemoteCells<dim>::in(const Cell &cell) const
  {
    const auto found = asked.find(cell);
    return found == asked.end() ? nullptr : &found->second;
  }

  template <int dim>
  void
  RemoteCells<dim>::answer(const std::vector<double> &values, const unsigned int width, Output::Samples &samples) const
  {
    using Part        = std::array<double, n_at_once>;
    const auto &first = remote.get_point_ptrs();
    samples.values.assign(samples.X.size() * width, 0.);
    for (unsigned int begin = 0; begin < width; begin += n_at_once)
      {
        const unsigned int n_here = std::min(n_at_once, width - begin);
        std::vector<Part>  parts, buffer;
        remote.template evaluate_and_process<Part>(parts, buffer,
                                                   [&](const dealii::ArrayView<Part> &mine, const auto &) {
                                                     for (std::size_t i = 0; i < mine.size(); ++i)
                                                       std::copy_n(values.data() + i * width + begin, n_here,
                                                                   mine[i].begin());
                                                   });
        for (std::size_t i = 0; i < samples.X.size(); ++i)
          for (unsigned int k = first[i]; k < first[i + 1]; ++k)
            for (unsigned int c = 0; c < n_here; ++c)
              samples.values[i * width + begin + c] += parts[k][c] / (first[i + 1] - first[i]);
      }
    samples.found.resize(samples.X.size());
    for (std::size_t i = 0; i < samples.X.size(); ++i)
      samples.found[i] = first[i + 1] > first[i];
  }

  template class RemoteCells<2>;
  template class RemoteCells<3>;
} // namespace Stroma::Fem
