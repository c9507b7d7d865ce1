#pragma once

#include <stroma/base/parameters.h>
#include <stroma/materials/material.h>
#include <stroma/materials/medium.h>
#include <stroma/processes/degradation.h>
#include <stroma/rigid/body.h>
#include <stroma/scene/body.h>
#include <stroma/scene/boundary.h>

#include <limits>
#include <memory>

namespace Stroma
{
  /// Contact of the bodies with a rigid body.
  struct Contact
  {
    enum class Type
    {
      stick,        ///< a point in contact moves with the rigid body until it is pulled off
      frictionless, ///< only the normal direction is held
      coulomb       ///< it sticks until the force along the surface reaches a part of that across, and slides then
    };

    std::string  name, where;
    unsigned int body     = 0; ///< the rigid one
    Type         type     = Type::stick;
    double       friction = std::numeric_limits<double>::quiet_NaN(); ///< coefficient; coulomb
  };

  /**
   * The problem, free of any method: what the bodies are, what they are made of, how they are held and loaded.
   */
  template <int dim>
  class Scene
  {
  public:
    /// Declares and reads the scene's sections. Throws UserError. Collective (images are read on rank 0).
    Scene(Parameters &p, MPI_Comm comm);

    /// Around all bodies that are not rigid.
    dealii::BoundingBox<dim> bounding_box() const;

    /// Whether all materials are fluids. A scene with both fluids and solids is refused when it is read.
    bool
    is_fluid() const
    {
      return media.front().is_fluid;
    }

    /// Material at @p X, if there is any: that of the last body in the file that takes up @p X.
    std::optional<unsigned int> material_at(const dealii::Point<dim> &X) const;

    /// Velocity at the start [m/s] at @p X: that of the last body in the file that takes up @p X, zero if it gives none.
    dealii::Tensor<1, dim> initial_velocity(const dealii::Point<dim> &X) const;

    /// Throws UserError if the scene has a part that method @p method does not handle.
    struct Abilities
    {
      bool fluids = false, viscosity = false, history = false, rigid_bodies = false, periodic = false, contact = false,
           contact_friction = false, boundary_loads = false, velocities = false, inertia = false;
      bool rigid_forces    = false; ///< rigid bodies that forces move, or that are free along an axis
      bool rigid_rotations = false; ///< rigid bodies that turn as given
      bool rigid_torques   = false; ///< rigid bodies that torques turn, or that are free to turn
      bool rigid_drag      = false; ///< a drag on rigid bodies that the balance of forces moves
      bool rigid_masses    = false; ///< their masses, with inertia
      bool rigid_approach  = false; ///< their way in a step while they touch nothing
      bool rate_laws       = false; ///< laws in rate form, Materials::Material::is_rate_form()
      bool total_laws      = true;  ///< elastic laws that are not
      bool migration       = false; ///< rigid bodies that propel themselves
      bool degradation     = false; ///< of solids by rigid bodies
    };
    void require(const std::string &method, const Abilities &abilities) const;

    /// What the laws of the materials are, for the summary, each law once. @param small whether strains are taken as small
    std::vector<std::string> laws_in_words(bool small = false) const;

    /// "FILE:12: material 'gel'", for messages on material @p m.
    std::string of_material(unsigned int m) const;

    /// Names of materials that no body holds.
    std::vector<std::string> unused_materials() const;

    /// Throws UserError for supports, loads and initial velocities that are not finite at the start, and known solutions
    /// that are not at @p end_time, as far as a coarse lattice of places in the bodies shows.
    void check_finite(double end_time) const;

    /// Throws UserError for supports and rigid bodies that are displaced at t = 0 already, when material is at rest: where
    /// forces follow from rates the first step would spread the jump, and its force would be that of how long it is.
    void check_rest_at_start() const;

    /// Whether a point of body @p b at @p X belongs to a body written later in the file (the later one wins).
    bool covered_by_later_body(unsigned int b, const dealii::Point<dim> &X) const;

    MPI_Comm                                          comm;
    std::string                                       title;
    double                                            thickness = 1.; ///< [m], 2D only
    Materials::PlaneModel                             plane     = Materials::PlaneModel::strain;
    std::vector<std::string>                          material_names, material_where, body_names;
    std::vector<std::unique_ptr<Materials::Material>> materials;
    std::vector<Materials::Medium>                    media; ///< one a material
    std::vector<Body<dim>>                            bodies;
    std::vector<Support<dim>>                         supports;
    std::vector<Load<dim>>                            loads;
    std::vector<Rigid::Body<dim>>                     rigid_bodies;   ///< in the order of bodies
    std::array<bool, dim>                             periodic{};     ///< directions in which the scene repeats
    std::string                                       where_periodic; ///< of these in the file
    std::vector<Contact>                              contacts;
    std::vector<Processes::Migration<dim>>            migrations;
    std::vector<Processes::Degradation<dim>>          degradations;

    // Known solution for error norms, where given.
    SpaceTimeVector<dim> exact_displacement, exact_velocity;
    SpaceTimeScalar<dim> exact_pressure, exact_von_mises;

  private:
    Rigid::Drive<dim> drive_of(unsigned int b) const;

    void check_supports_and_loads() const;
    void make_rigid_bodies();
    void check_rigid_body(const Rigid::Body<dim> &rigid) const;
    void require_drives(const std::string &method, const Abilities &abilities) const;
    void add_periodic(Parameters &p);
    void add_contacts(Parameters &p);
    void add_processes(Parameters &p, bool thickness_is_given);
    void check_propelled_body(const Processes::Migration<dim> &migration) const;
    void add_exact_solution(Parameters &p);
  };
} // namespace Stroma
