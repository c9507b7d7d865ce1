#include <stroma/image/pieces.h>
#include <stroma/scans/loose_pieces.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace Stroma::Scans
{
  namespace
  {
    /// A voxel as supports see it: its centre first, then its corners.
    template <int dim>
    struct Voxel
    {
      std::vector<dealii::Point<dim>> places;
      dealii::Tensor<1, dim>          edges;
      unsigned int                    material;
    };

    template <int dim>
    Voxel<dim>
    voxel_at(const VoxelMaterials &voxels, const std::array<unsigned int, 3> &index)
    {
      Voxel<dim>         voxel;
      dealii::Point<dim> lower;
      for (unsigned int d = 0; d < dim; ++d)
        {
          voxel.edges[d] = voxels.voxel_size[d];
          lower[d]       = voxels.corner[d] + index[d] * voxels.voxel_size[d];
        }
      voxel.material = voxels.at(index[0], index[1], index[2]);
      voxel.places.push_back(lower + voxel.edges / 2);
      for (unsigned int corner = 0; corner < (1u << dim); ++corner)
        {
          dealii::Point<dim> place = lower;
          for (unsigned int d = 0; d < dim; ++d)
            place[d] += (corner >> d & 1) * voxel.edges[d];
          voxel.places.push_back(place);
        }
      return voxel;
    }

    template <int dim>
    bool
    touches(const Voxel<dim> &voxel, const Scene<dim> &scene, const Region<dim> &region,
            const dealii::BoundingBox<dim> &bodies)
    {
      using Kind           = typename Region<dim>::Kind;
      const auto any_place = [&](const auto &is_in) {
        return std::any_of(voxel.places.begin(), voxel.places.end(), is_in);
      };
      constexpr double rounding = 1 + 1e-6;
      switch (region.kind)
        {
          case Kind::side:
            return region.on_side(voxel.places.front(), bodies, .5 * rounding * voxel.edges[region.axis]);
          case Kind::rim:
            return region.on_boundary(voxel.places.front(), bodies, .5 * rounding * voxel.edges.norm());
          case Kind::body:
            return any_place([&](const auto &X) { return scene.bodies[region.body].contains(X); });
          case Kind::nearest:
            return voxel.places.front().distance(region.first) <= .5 * rounding * voxel.edges.norm();
          default:
            return any_place([&](const auto &X) { return region.contains(X, voxel.material, bodies); });
        }
    }

    /// Whether a support holds the voxel, or another body that it reaches into.
    template <int dim>
    bool
    is_held(const Voxel<dim> &voxel, const Scene<dim> &scene, const unsigned int b,
            const dealii::BoundingBox<dim> &bodies)
    {
      for (const auto &support : scene.supports)
        if (touches(voxel, scene, support.region, bodies))
          return true;
      for (unsigned int other = 0; other < scene.bodies.size(); ++other)
        if (other != b && std::any_of(voxel.places.begin(), voxel.places.end(),
                                      [&](const auto &X) { return scene.bodies[other].contains(X); }))
          return true;
      return false;
    }
  } // namespace

  template <int dim>
  LoosePieces
  loose_pieces(const Scene<dim> &scene, const unsigned int b)
  {
    const VoxelMaterials       &voxels = scene.bodies[b].voxels;
    Image::Volume<std::uint8_t> mask{voxels.size, voxels.voxel_size, {}, {}};
    mask.data.resize(mask.n_voxels());
    std::transform(voxels.material.begin(), voxels.material.end(), mask.data.begin(),
                   [](const std::uint8_t material) { return material != VoxelMaterials::empty; });
    const auto                  pieces = Image::find_pieces(mask, Image::Connectivity::faces);
    const auto                  bodies = scene.bounding_box();
    std::vector<bool>           held(pieces.size.size(), false);
    std::array<unsigned int, 3> i;
    for (i[2] = 0; i[2] < voxels.size[2]; ++i[2])
      for (i[1] = 0; i[1] < voxels.size[1]; ++i[1])
        for (i[0] = 0; i[0] < voxels.size[0]; ++i[0])
          if (const auto piece = pieces.number.at(i[0], i[1], i[2]); piece > 0 && !held[piece - 1])
            held[piece - 1] = is_held(voxel_at<dim>(voxels, i), scene, b, bodies);
    LoosePieces found;
    found.n            = held.size();
    std::size_t n_all  = 0;
    std::size_t n_free = 0;
    for (std::size_t piece = 0; piece < held.size(); ++piece)
      {
        n_all += pieces.size[piece];
        n_free += held[piece] ? 0 : pieces.size[piece];
        found.n_loose += !held[piece];
      }
    found.share_loose = n_all > 0 ? double(n_free) / n_all : 0.;
    return found;
  }

  template LoosePieces loose_pieces(const Scene<2> &, unsigned int);
  template LoosePieces loose_pieces(const Scene<3> &, unsigned int);
} // namespace Stroma::Scans
