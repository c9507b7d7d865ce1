#include <stroma/base/text.h>
#include <stroma/scene/doubts.h>
#include <stroma/scene/reactions.h>

#include <algorithm>
#include <numeric>

namespace Stroma
{
  namespace
  {
    constexpr double densest = 1e5; ///< [kg/m^3]; osmium has 2.3e4

    template <int dim>
    double
    distance(const dealii::BoundingBox<dim> &a, const dealii::BoundingBox<dim> &b)
    {
      dealii::Tensor<1, dim> gap;
      for (unsigned int d = 0; d < dim; ++d)
        gap[d] = std::max({0., a.lower_bound(d) - b.upper_bound(d), b.lower_bound(d) - a.upper_bound(d)});
      return gap.norm();
    }

    /// Numbers of the bodies whose boxes touch that of @p first, or of one that does, and of the others.
    template <int dim>
    std::pair<std::vector<unsigned int>, std::vector<unsigned int>>
    near_and_apart(const Scene<dim> &scene, const unsigned int first)
    {
      const double              tolerance = 1e-9 * scene.bounding_box().side_length(0);
      std::vector<unsigned int> near{first}, apart(scene.bodies.size());
      std::iota(apart.begin(), apart.end(), 0u);
      apart.erase(apart.begin() + first);
      for (std::size_t i = 0; i < near.size(); ++i)
        for (auto other = apart.begin(); other != apart.end();)
          if (distance(scene.bodies[near[i]].bounding_box(), scene.bodies[*other].bounding_box()) <= tolerance)
            {
              near.push_back(*other);
              other = apart.erase(other);
            }
          else
            ++other;
      return {near, apart};
    }

    /// What moves one does not strain the other, and a section of both is not that of either.
    template <int dim>
    void
    add_bodies_apart(const Scene<dim> &scene, std::vector<std::string> &found)
    {
      const bool is_repeated = std::find(scene.periodic.begin(), scene.periodic.end(), true) != scene.periodic.end();
      if (is_repeated || !has_driven_end(scene))
        return;
      const auto   is_rigid = [&](const unsigned int b) { return scene.bodies[b].rigid; };
      unsigned int first    = 0;
      while (is_rigid(first))
        ++first;
      auto [near, apart] = near_and_apart(scene, first);
      apart.erase(std::remove_if(apart.begin(), apart.end(), is_rigid), apart.end());
      if (apart.empty())
        return;
      double gap = std::numeric_limits<double>::max();
      for (const unsigned int b : near)
        gap = std::min(gap, distance(scene.bodies[b].bounding_box(), scene.bodies[apart.front()].bounding_box()));
      found.push_back("body '" + scene.bodies[apart.front()].name + "' lies " + brief(gap) + " m apart from '" +
                      scene.bodies[first].name +
                      "': no force passes between them, and strain, section and apparent modulus are those of the box "
                      "around all bodies");
    }

    /// Forces where two supports hold the same component of the same material are those of the first in the file.
    template <int dim>
    void
    add_shared_edges(const Scene<dim> &scene, std::vector<std::string> &found)
    {
      const auto is_side = [](const Support<dim> &s) { return s.region.kind == Region<dim>::Kind::side; };
      for (unsigned int axis = 0; axis < dim; ++axis)
        for (unsigned int c = 0; c < dim; ++c)
          {
            const auto *driving = driving_support(scene, axis, c);
            if (!driving || !is_side(*driving))
              continue;
            const auto other = std::find_if(scene.supports.begin(), scene.supports.end(), [&](const auto &s) {
              return is_side(s) && s.region.axis != axis && s.holds(c);
            });
            if (other == scene.supports.end())
              continue;
            found.push_back(other->where + ": support '" + other->name + "' holds an edge of '" + driving->name +
                            "' along " + "xyz"[c] +
                            " too: what acts there counts for that which comes first in the file, so that " +
                            "reactions, stress and apparent modulus are of a part of the side");
            return;
          }
    }
  } // namespace

  template <int dim>
  std::vector<std::string>
  doubts(const Scene<dim> &scene)
  {
    std::vector<std::string> found;
    for (const auto &name : scene.unused_materials())
      found.push_back("no body is made of material '" + name + "'");
    add_bodies_apart(scene, found);
    add_shared_edges(scene, found);
    for (unsigned int m = 0; m < scene.media.size(); ++m)
      if (scene.media[m].density > densest)
        found.push_back(scene.of_material(m) + " has a density of " + brief(scene.media[m].density) +
                        " kg/m^3; 'Density' counts in the file's units of mass and length");
    return found;
  }

  template std::vector<std::string> doubts(const Scene<2> &);
  template std::vector<std::string> doubts(const Scene<3> &);
} // namespace Stroma
