#include <stroma/base/on_root.h>
#include <stroma/simulation/image_fields.h>

#include <deal.II/base/exceptions.h>
#include <deal.II/base/mpi.h>
#include <deal.II/base/utilities.h>

#include <algorithm>
#include <filesystem>
#include <limits>

namespace Stroma
{
  namespace
  {
    /// Sums over the sample points of this rank in each voxel: of their volume, and of each value times that. Only rows of
    /// voxels with points are there.
    class VoxelSums
    {
    public:
      VoxelSums(const VoxelMaterials &image, const unsigned int dim, const unsigned int width)
        : image(image)
        , dim(dim)
        , stride(width + 1)
        , rows(std::size_t(image.size[1]) * image.size[2])
      {
        for (unsigned int d = 0; d < dim; ++d)
          volume *= image.voxel_size[d];
      }

      void
      add(const Output::PointState &point, const std::vector<double> &values)
      {
        std::array<unsigned int, 3> voxel{{0, 0, 0}};
        for (unsigned int d = 0; d < dim; ++d)
          {
            const double place = (point.X[d] - image.corner[d]) / image.voxel_size[d];
            if (!(place >= 0. && place < image.size[d]))
              return; // of another body
            voxel[d] = static_cast<unsigned int>(place);
          }
        auto &row = rows[std::size_t(voxel[2]) * image.size[1] + voxel[1]];
        if (row.empty())
          row.assign(std::size_t(image.size[0]) * stride, 0.f);
        const double weight = point.V0 / volume;
        float       *sums   = &row[std::size_t(voxel[0]) * stride];
        *sums++ += static_cast<float>(weight);
        for (const double value : values)
          *sums++ += static_cast<float>(weight * value);
      }

      /// Those of all ranks in slice @p z, row by row, on rank 0; this rank's are dropped. Collective.
      std::vector<float>
      take_slice(const unsigned int z, const MPI_Comm comm)
      {
        const std::size_t  row_size = std::size_t(image.size[0]) * stride;
        std::vector<float> own(row_size * image.size[1], 0.f), all(own.size());
        for (unsigned int y = 0; y < image.size[1]; ++y)
          if (auto &row = rows[std::size_t(z) * image.size[1] + y]; !row.empty())
            {
              std::copy(row.begin(), row.end(), own.begin() + y * row_size);
              row = {};
            }
        if (dealii::Utilities::MPI::n_mpi_processes(comm) == 1)
          return own;
        const int error = MPI_Reduce(own.data(), all.data(), static_cast<int>(own.size()), MPI_FLOAT, MPI_SUM, 0, comm);
        AssertThrowMPI(error);
        return all;
      }

    private:
      const VoxelMaterials           &image;
      const unsigned int              dim, stride;
      double                          volume = 1.; ///< of a voxel [m^dim]
      std::vector<std::vector<float>> rows;
    };

    Image::ScalarGrid
    grid_of(const VoxelMaterials &image)
    {
      Image::ScalarGrid grid{image.size, image.voxel_size, image.frame};
      for (double &spacing : grid.spacing)
        spacing /= image.frame.unit;
      return grid;
    }
  } // namespace

  std::string
  write_image_fields(const Output::StateView &state, const VoxelMaterials &image, const OutputSettings &settings,
                     const Output::FieldRequest &request, const unsigned int dim, const Output::StateView::Visit &also,
                     const MPI_Comm comm)
  {
    const Output::StateFields fields(dim, Output::StateFields::in_order(settings.image_fields));
    VoxelSums                 sums(image, dim, fields.width());
    std::vector<std::string>  names;
    for (const auto &number : fields.numbers())
      names.push_back(request.units.name(number.stem(), number.unit));
    const auto          factors = fields.factors(request.units);
    std::vector<double> values(fields.width());
    state.for_each_point([&](const Output::PointState &point) {
      fields.fill(point, values.data());
      for (unsigned int k = 0; k < values.size(); ++k)
        values[k] *= factors[k];
      sums.add(point, values);
      if (also)
        also(point);
    });

    std::unique_ptr<Image::ScalarImages> images;
    on_root(comm, [&] {
      images = Image::ScalarImages::make(settings.image_format, request.folder + "/voxels",
                                         dealii::Utilities::int_to_string(request.counter, 4), names, grid_of(image));
    });
    std::vector<float> one(std::size_t(image.size[0]) * image.size[1]);
    for (unsigned int z = 0; z < image.size[2]; ++z)
      {
        const auto slice = sums.take_slice(z, comm);
        on_root(comm, [&] {
          for (std::size_t i = 0; i < names.size(); ++i)
            {
              const std::size_t stride = names.size() + 1;
              for (std::size_t k = 0; k < one.size(); ++k)
                one[k] = slice[k * stride] > 0.f ? slice[k * stride + 1 + i] / slice[k * stride] :
                                                   std::numeric_limits<float>::quiet_NaN();
              images->add(i, one);
            }
        });
      }
    std::string first;
    on_root(comm, [&] {
      images->close();
      first = std::filesystem::path(images->paths.front()).filename();
    });
    return dealii::Utilities::MPI::broadcast(comm, first, 0);
  }
} // namespace Stroma
