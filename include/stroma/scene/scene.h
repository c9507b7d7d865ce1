#pragma once

#include <stroma/base/parameters.h>
#include <stroma/materials/material.h>
#include <stroma/scene/body.h>
#include <stroma/scene/boundary.h>

#include <memory>

namespace Stroma
{
  /**
   * The problem, free of any method: what the bodies are, what they are made of, how they are held and loaded.
   */
  template <int dim>
  class Scene
  {
  public:
    /// Declares and reads the scene's sections. Throws UserError. Collective (images are read on rank 0).
    Scene(Parameters &p, MPI_Comm comm);

    dealii::BoundingBox<dim> bounding_box() const;

    /// Whether a point of body @p b at @p X belongs to a body written later in the file (the later one wins).
    bool covered_by_later_body(unsigned int b, const dealii::Point<dim> &X) const;

    MPI_Comm                                          comm;
    std::string                                       title;
    double                                            thickness = 1.; ///< [m], 2D only
    Materials::PlaneModel                             plane     = Materials::PlaneModel::strain;
    std::vector<std::string>                          material_names;
    std::vector<std::unique_ptr<Materials::Material>> materials;
    std::vector<Body<dim>>                            bodies;
    std::vector<Support<dim>>                         supports;
    std::vector<Load<dim>>                            loads;
    SpaceTimeVector<dim>                              exact_displacement; ///< for error norms, if given
  };
} // namespace Stroma
