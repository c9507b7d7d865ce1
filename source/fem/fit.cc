#include <stroma/fem/fit.h>

#include <algorithm>

namespace Stroma::Fem
{
  namespace
  {
    constexpr double       round_off = 1e-6; ///< over the cell's size
    constexpr unsigned int n_fine    = 16;   ///< samples along each axis where a body is curved or oblique
  }                                          // namespace

  template <int dim>
  Fit<dim>::Fit(const Scene<dim> &scene)
    : scene(scene)
  {
    for (const auto &body : scene.bodies)
      {
        if (!body.is_box() && !body.is_image())
          others.push_back(&body);
        for (unsigned int d = 0; d < dim; ++d)
          if (body.is_box())
            edges[d].insert(edges[d].end(), {body.bounding_box().lower_bound(d), body.bounding_box().upper_bound(d)});
          else if (body.is_image())
            for (unsigned int v = 0; v <= body.voxels.size[d]; ++v)
              edges[d].push_back(body.voxels.corner[d] + v * body.voxels.voxel_size[d]);
      }
    for (auto &along : edges)
      std::sort(along.begin(), along.end());
  }

  template <int dim>
  void
  Fit<dim>::for_each_part(const dealii::BoundingBox<dim> &cell, const Visit &visit) const
  {
    const auto                          &corners = cell.get_boundary_points();
    std::array<std::vector<double>, dim> cuts; // of the cell, its own sides included
    std::size_t                          n = 1;
    for (unsigned int d = 0; d < dim; ++d)
      {
        const double tolerance = round_off * cell.side_length(d);
        cuts[d]                = {corners.first[d]};
        for (auto edge = std::upper_bound(edges[d].begin(), edges[d].end(), corners.first[d] + tolerance);
             edge != edges[d].end() && *edge < corners.second[d] - tolerance; ++edge)
          if (*edge > cuts[d].back() + tolerance)
            cuts[d].push_back(*edge);
        cuts[d].push_back(corners.second[d]);
        n *= cuts[d].size() - 1;
      }
    for (std::size_t i = 0; i < n; ++i)
      {
        std::size_t        rest  = i;
        double             share = 1.;
        dealii::Point<dim> centre;
        for (unsigned int d = 0; d < dim; ++d)
          {
            const std::size_t k = rest % (cuts[d].size() - 1);
            rest /= cuts[d].size() - 1;
            centre[d] = .5 * (cuts[d][k] + cuts[d][k + 1]);
            share *= (cuts[d][k + 1] - cuts[d][k]) / cell.side_length(d);
          }
        visit(centre, share);
      }
  }

  template <int dim>
  std::vector<dealii::Point<dim>>
  Fit<dim>::probes(const dealii::BoundingBox<dim> &cell) const
  {
    const auto                      centre = cell.center();
    std::vector<dealii::Point<dim>> places;
    for (unsigned int v = 0; v < 1u << dim; ++v)
      places.push_back(cell.vertex(v));
    for (const auto *body : others)
      {
        auto nearest = body->bounding_box().center();
        for (unsigned int d = 0; d < dim; ++d)
          nearest[d] = std::clamp(nearest[d], cell.lower_bound(d), cell.upper_bound(d));
        places.push_back(nearest);
      }
    for (auto &place : places)
      place += round_off * (centre - place); // off the cell's own sides
    return places;
  }

  template <int dim>
  std::optional<typename Fit<dim>::Material>
  Fit<dim>::other_than_at_centre(const dealii::BoundingBox<dim> &cell) const
  {
    const Material          inside = scene.material_at(cell.center());
    std::optional<Material> other;
    for_each_part(cell, [&](const dealii::Point<dim> &place, const double) {
      if (const Material there = scene.material_at(place); !other && there != inside)
        other = there;
    });
    for (const auto &place : probes(cell))
      if (const Material there = scene.material_at(place); !other && there != inside)
        other = there;
    return other;
  }

  template <int dim>
  double
  Fit<dim>::filled_share(const dealii::BoundingBox<dim> &cell) const
  {
    bool is_cut = false;
    if (!others.empty())
      {
        const bool inside = bool(scene.material_at(cell.center()));
        for (const auto &place : probes(cell))
          is_cut |= bool(scene.material_at(place)) != inside;
      }
    double share = 0.;
    if (!is_cut)
      {
        for_each_part(cell, [&](const dealii::Point<dim> &place, const double part) {
          share += scene.material_at(place) ? part : 0.;
        });
        return share;
      }
    unsigned int n = 1;
    for (unsigned int d = 0; d < dim; ++d)
      n *= n_fine;
    for (unsigned int i = 0; i < n; ++i)
      {
        dealii::Point<dim> unit;
        for (unsigned int d = 0, rest = i; d < dim; ++d, rest /= n_fine)
          unit[d] = (rest % n_fine + .5) / n_fine;
        share += scene.material_at(cell.unit_to_real(unit)) ? 1. / n : 0.;
      }
    return share;
  }

  template class Fit<2>;
  template class Fit<3>;
} // namespace Stroma::Fem
