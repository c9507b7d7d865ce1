#pragma once

#include <stroma/base/text.h>
#include <stroma/particles/arrangement.h>

#include <string>
#include <vector>

/// A scene and the movers of its fixed particles, from the text of a parameter file.
template <int dim>
struct ParticleScene
{
  explicit ParticleScene(const std::string &text, const std::vector<std::string> &set = {})
    : ParticleScene(Stroma::ParameterFile::parse(text, "test.prm"), set)
  {}

  ParticleScene(Stroma::ParameterFile given, const std::vector<std::string> &set)
    : file(with(std::move(given), set))
    , parameters(file)
    , scene(parameters, MPI_COMM_WORLD)
    , movers(Stroma::Particles::movers_of(scene))
  {}

  /// One of the scenes in parameters/heck2017.
  static ParticleScene
  heck(const std::string &name, const std::vector<std::string> &set = {})
  {
    return ParticleScene(Stroma::ParameterFile::read(std::string(STROMA_SOURCE_DIR) + "/parameters/heck2017/" + name +
                                                     ".prm"),
                         set);
  }

  Stroma::Particles::ParticleSet<dim>
  arrange(const double spacing, const double reach = 0.,
          const Stroma::Particles::ArrangementName name   = Stroma::Particles::ArrangementName::square,
          const double                             jitter = 0.)
  {
    Stroma::Particles::ArrangementSettings settings;
    settings.spacing = spacing;
    settings.name    = name;
    settings.jitter  = jitter;
    return Stroma::Particles::arrange(scene, settings, movers, reach);
  }

  /// The same with all particles on each rank.
  Stroma::Particles::ParticleSet<dim>
  arrange_alone(const double spacing, const double reach, const Stroma::Particles::ArrangementName name,
                const double jitter)
  {
    scene.comm           = MPI_COMM_SELF;
    const auto particles = arrange(spacing, reach, name, jitter);
    scene.comm           = MPI_COMM_WORLD;
    return particles;
  }

  Stroma::ParameterFile                      file;
  Stroma::Parameters                         parameters;
  Stroma::Scene<dim>                         scene;
  std::vector<Stroma::Particles::Mover<dim>> movers;

private:
  static Stroma::ParameterFile
  with(Stroma::ParameterFile file, const std::vector<std::string> &set)
  {
    for (const auto &assignment : set)
      file.set(assignment);
    return file;
  }
};

/// Whether @p some are those of @p all whose id modulo the number of ranks is this rank's, to the last digit.
template <int dim>
bool
are_share_of(const Stroma::Particles::ParticleSet<dim> &some, const Stroma::Particles::ParticleSet<dim> &all)
{
  const unsigned int n_ranks = dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
  const unsigned int rank    = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
  unsigned int       j       = 0;
  for (unsigned int i = 0; i < all.size(); ++i)
    if (all.id[i] % n_ranks == rank)
      {
        if (j == some.size() || some.id[j] != all.id[i] || some.X[j] != all.X[i] || some.V0[j] != all.V0[i] ||
            some.mover[j] != all.mover[i])
          return false;
        ++j;
      }
  return j == some.size();
}

/// A hypoelastic material of Young's modulus @p E, with @p more entries, a line each.
inline std::string
hypoelastic(const std::string &name, const double E, const double nu, const std::string &more = "")
{
  return " subsection " + name + "\n  set Law = hypoelastic\n  set Young's modulus = " + Stroma::shortest(E) +
         "\n  set Poisson's ratio = " + Stroma::shortest(nu) + "\n" + more + " end\n";
}

/// A box from the origin to @p upper_corner, with @p more entries, a line each.
inline std::string
box_body(const std::string &name, const std::string &upper_corner, const std::string &more = "")
{
  return " subsection " + name + "\n  set Shape = box\n  set Upper corner = " + upper_corner + "\n" + more + " end\n";
}

/// A scene of these materials and bodies, and @p more sections.
inline std::string
scene_of(const std::string &materials, const std::string &bodies, const std::string &more = "")
{
  return "subsection Materials\n" + materials + "end\nsubsection Bodies\n" + bodies + "end\n" + more;
}

/// A material in a box from the origin to @p upper_corner, and more sections; supports and the like.
inline std::string
box_of_gel(const std::string &upper_corner, const std::string &more = "", const std::string &more_bodies = "")
{
  return scene_of(hypoelastic("gel", 1., .3) + hypoelastic("stiff", 9., .3),
                  box_body("block", upper_corner, "  set Material = gel\n") + more_bodies, more);
}

/// A section Supports of one clamp for each side named.
inline std::string
clamped(const std::vector<std::string> &sides)
{
  std::string text = "subsection Supports\n";
  for (const auto &side : sides)
    text += " subsection " + side + "\n  set Where = side " + side + "\n  set Type = clamp\n end\n";
  return text + "end\n";
}
