#include <stroma/scene/body_part.h>

#include <algorithm>

namespace Stroma
{
  namespace
  {
    /// Cuts the box down to the body's own. False if nothing is left.
    template <int dim>
    bool
    clip(dealii::Point<dim> &lower, dealii::Point<dim> &upper, const Body<dim> &body,
         const dealii::Tensor<1, dim> &slack)
    {
      const auto [start, end] = body.bounding_box().get_boundary_points();
      for (unsigned int d = 0; d < dim; ++d)
        {
          if (start[d] > lower[d] + slack[d])
            lower[d] = start[d];
          if (end[d] < upper[d] - slack[d])
            upper[d] = end[d];
          if (upper[d] - lower[d] <= slack[d])
            return false;
        }
      return true;
    }

    /// The bodies after body @p b that reach into a box.
    template <int dim>
    std::vector<const Body<dim> *>
    bodies_in(const Scene<dim> &scene, const unsigned int b, const dealii::Point<dim> &lower,
              const dealii::Point<dim> &upper, const dealii::Tensor<1, dim> &slack)
    {
      std::vector<const Body<dim> *> later;
      for (unsigned int l = b + 1; l < scene.bodies.size(); ++l)
        {
          const auto [start, end] = scene.bodies[l].bounding_box().get_boundary_points();
          bool meets              = true;
          for (unsigned int d = 0; d < dim; ++d)
            meets &= std::min(end[d], upper[d]) - std::max(start[d], lower[d]) > slack[d];
          if (meets)
            later.push_back(&scene.bodies[l]);
        }
      return later;
    }

    /// A box, cut along planes.
    template <int dim>
    struct CutBox
    {
      std::array<std::vector<double>, dim> planes; ///< in each direction, in order, the box's ends included

      void
      cut(const unsigned int d, const double place, const double slack)
      {
        const auto after = std::upper_bound(planes[d].begin(), planes[d].end(), place);
        if (after != planes[d].begin() && after != planes[d].end() && place - *(after - 1) > slack &&
            *after - place > slack)
          planes[d].insert(after, place);
      }

      /// Calls @p visit(X, volume) for @p n samples along each edge of each piece.
      template <typename Visit>
      void
      sample(const unsigned int n, const Visit &visit) const
      {
        std::array<std::vector<std::pair<double, double>>, dim> axes; // place, length
        std::size_t                                             all = 1;
        for (unsigned int d = 0; d < dim; ++d)
          {
            for (std::size_t i = 0; i + 1 < planes[d].size(); ++i)
              for (unsigned int k = 0; k < n; ++k)
                {
                  const double length = (planes[d][i + 1] - planes[d][i]) / n;
                  axes[d].emplace_back(planes[d][i] + (k + .5) * length, length);
                }
            all *= axes[d].size();
          }
        for (std::size_t i = 0; i < all; ++i)
          {
            std::size_t        rest   = i;
            double             volume = 1;
            dealii::Point<dim> X;
            for (unsigned int d = 0; d < dim; ++d)
              {
                const auto &[place, length] = axes[d][rest % axes[d].size()];
                rest /= axes[d].size();
                X[d] = place;
                volume *= length;
              }
            visit(X, volume);
          }
      }
    };
  } // namespace

  template <int dim>
  double
  volume_of(const Body<dim> &body)
  {
    if (body.shape)
      return body.shape->volume();
    const auto &voxels = body.voxels;
    double      volume = voxels.material.size() -
                    std::count(voxels.material.begin(), voxels.material.end(), VoxelMaterials::empty);
    for (unsigned int d = 0; d < dim; ++d)
      volume *= voxels.voxel_size[d];
    return volume;
  }

  template <int dim>
  BodyPart<dim>
  part_in(const Scene<dim> &scene, const unsigned int b, const dealii::Point<dim> &lower,
          const dealii::Point<dim> &upper)
  {
    const Body<dim>             &body  = scene.bodies[b];
    const dealii::Tensor<1, dim> slack = 1e-9 * (upper - lower);
    dealii::Point<dim>           first = lower, second = upper;
    if (body.shape && !clip(first, second, body, slack))
      return {};
    const bool   is_curved = !body.is_image() && !body.is_box();
    const double depth     = is_curved ? -body.shape->distance(first + .5 * (second - first)) : 0.;
    const double reach     = .5 * first.distance(second); // the surface passes by if it is further from the centre
    if (is_curved && depth < -reach)
      return {};
    const auto later      = bodies_in(scene, b, first, second, slack);
    const bool is_sampled = (is_curved && depth < reach) ||
                            std::any_of(later.begin(), later.end(), [](const auto *l) { return !l->is_box(); });
    BodyPart<dim> part;
    if (!is_sampled && later.empty())
      {
        part.whole = 1;
        for (unsigned int d = 0; d < dim; ++d)
          part.whole *= second[d] - first[d];
        part.visible  = part.whole;
        part.centroid = first + .5 * (second - first);
        return part;
      }
    CutBox<dim> box;
    for (unsigned int d = 0; d < dim; ++d)
      {
        box.planes[d] = {first[d], second[d]};
        for (const auto *l : later)
          for (const double place : {l->bounding_box().lower_bound(d), l->bounding_box().upper_bound(d)})
            box.cut(d, place, slack[d]);
      }
    box.sample(is_sampled ? (dim == 2 ? 16 : 8) : 1, [&](const dealii::Point<dim> &X, const double volume) {
      if (body.shape && !body.contains(X))
        return;
      part.whole += volume;
      if (std::any_of(later.begin(), later.end(), [&](const auto *l) { return l->contains(X); }))
        return;
      part.visible += volume;
      part.centroid += volume * X;
    });
    if (part.visible > 0)
      part.centroid /= part.visible;
    return part;
  }

  template double      volume_of(const Body<2> &);
  template double      volume_of(const Body<3> &);
  template BodyPart<2> part_in(const Scene<2> &, unsigned int, const dealii::Point<2> &, const dealii::Point<2> &);
  template BodyPart<3> part_in(const Scene<3> &, unsigned int, const dealii::Point<3> &, const dealii::Point<3> &);
} // namespace Stroma
