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

  FileNotes
  FieldRequest::notes(const std::string &positions) const
  {
    return {{"positions", {positions}}, {"length_unit", {units.of("m").name}}, {"material_names", material_names}};
  }

  PointRecords
  write_points(const StateView &state, const unsigned int dim, const FieldRequest &request, const MPI_Comm comm)
  {
    const StateFields fields(dim, StateFields::in_order(request.point_fields));
    const auto        writer_of = [&](const std::string &stem) {
      return PointWriter<3>(request.folder, stem, request.counter, fields.list(request.units), comm, request.format,
                            request.notes("deformed"));
    };
    auto                material = writer_of("points"), walls = writer_of("walls");
    const auto          factors = fields.factors(request.units);
    const double        length  = request.units.of("m").factor;
    std::vector<double> values(fields.width());
    unsigned int        has_walls = 0;
    state.for_each_point([&](const PointState &point) {
      fields.fill(point, values.data());
      for (unsigned int k = 0; k < values.size(); ++k)
        values[k] *= factors[k];
      has_walls = has_walls || point.is_fixed;
      (point.is_fixed ? walls : material)
        .add(dealii::Point<3>(length * point_of<3>(point.x)), dealii::make_array_view(values));
    });
    PointRecords records{material.close(), ""};
    if (dealii::Utilities::MPI::max(has_walls, comm) > 0)
      records.walls = walls.close();
    return records;
  }

  CellMeans
  cell_means(const StateView &state, const StateFields &fields, const unsigned int n_cells)
  {
    CellMeans means;
    means.numbers = fields.numbers();
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
    for (unsigned int k = 0; k < numbers.size(); ++k)
      list.push_back({numbers[k].stem(), numbers[k].unit, &values[k]});
    return list;
  }
} // namespace Stroma::Output
