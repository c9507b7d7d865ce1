#include <stroma/output/state_view.h>

namespace Stroma::Output
{
  Samples
  own_samples(const StateView &state, const StateFields &fields)
  {
    Samples            samples;
    const unsigned int width = fields.width();
    samples.X.reserve(state.n_points());
    samples.weight.reserve(state.n_points());
    samples.material.reserve(state.n_points());
    samples.values.reserve(state.n_points() * width);
    state.for_each_point([&](const PointState &point) {
      if (point.is_fixed)
        return;
      samples.X.push_back(point.X);
      samples.weight.push_back(point.V0);
      samples.material.push_back(point.material);
      samples.values.resize(samples.values.size() + width);
      fields.fill(point, samples.values.data() + samples.values.size() - width);
    });
    return samples;
  }

  std::string
  write_points(const StateView &state, const unsigned int dim, const FieldRequest &request, const MPI_Comm comm)
  {
    const StateFields   fields(dim, StateFields::in_order(request.point_fields));
    PointWriter<3>      writer(request.folder, "points", request.counter, fields.list(), comm, request.format,
                               request.material_names);
    std::vector<double> values(fields.width());
    state.for_each_point([&](const PointState &point) {
      fields.fill(point, values.data());
      writer.add(point_of<3>(point.x), dealii::make_array_view(values));
    });
    return writer.close();
  }

  CellMeans
  cell_means(const StateView &state, const StateFields &fields, const unsigned int n_cells)
  {
    CellMeans means;
    for (const auto &number : fields.numbers())
      means.names.push_back(number.name());
    means.values.assign(fields.width(), dealii::Vector<double>(n_cells));
    means.volume.reinit(n_cells);
    std::vector<double> values(fields.width());
    state.for_each_point([&](const PointState &point) {
      fields.fill(point, values.data());
      means.volume[point.cell] += point.V0;
      for (unsigned int k = 0; k < values.size(); ++k)
        means.values[k][point.cell] += point.V0 * values[k];
    });
    for (auto &sums : means.values)
      for (unsigned int c = 0; c < n_cells; ++c)
        if (means.volume[c] > 0.)
          sums[c] /= means.volume[c];
    return means;
  }

  std::vector<CellField>
  CellMeans::fields() const
  {
    std::vector<CellField> list;
    for (unsigned int k = 0; k < names.size(); ++k)
      list.push_back({names[k], &values[k]});
    return list;
  }
} // namespace Stroma::Output
