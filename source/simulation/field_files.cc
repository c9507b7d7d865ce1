#include <stroma/output/folder.h>
#include <stroma/simulation/field_files.h>
#include <stroma/simulation/image_fields.h>

#include <algorithm>

namespace Stroma
{
  FieldFiles::FieldFiles(const OutputSettings &settings, const std::string &folder, const unsigned int dim,
                         const std::vector<std::string> &material_names, const VoxelMaterials *const image,
                         const MPI_Comm comm)
    : settings(settings)
    , folder(folder)
    , dim(dim)
    , material_names(material_names)
    , image(image)
    , has_gradients(Output::StateFields(dim, settings.point_fields).has_gradients())
    , comm(comm)
  {}

  Output::PvdSeries &
  FieldFiles::list(const std::string &file_name)
  {
    return lists.try_emplace(file_name, folder + "/" + file_name, comm).first->second;
  }

  bool
  FieldFiles::resume(const double time, const unsigned int n_records)
  {
    number          = n_records;
    bool has_record = false;
    for (const auto &name : Output::series_files(folder, comm))
      {
        auto &series = list(name);
        series.restore(time);
        number     = std::max(number, series.next_number());
        has_record = series.has(time) || has_record;
      }
    return has_record;
  }

  void
  FieldFiles::write(Method &method, const Output::StateView::Visit &also)
  {
    const Output::FieldRequest request{folder,          number,         settings.point_fields, settings.grid_fields,
                                       settings.format, material_names, settings.units};
    if (!settings.point_fields.empty())
      {
        const auto        records = Output::write_points(*method.state(has_gradients), dim, request, comm);
        const std::string ending  = settings.format == Output::Format::xdmf ? ".xdmf" : ".pvd";
        list("points" + ending).add(method.time, records.points);
        if (!records.walls.empty())
          list("walls" + ending).add(method.time, records.walls);
      }
    if (!settings.image_fields.empty())
      list("voxels.pvd")
        .add(method.time, write_image_fields(*method.state(false), *image, settings, request, dim, also, comm));
    if (const auto record = method.write_grid(request); !record.empty())
      list("grid.pvd").add(method.time, record);
    ++number;
  }
} // namespace Stroma
