#pragma once

#include "../base/message_of.h"

#include <stroma/scene/scene.h>

/// A scene from the text of a parameter file: two materials 'gel' and 'stiff', the bodies given, and more sections.
template <int dim>
struct SceneOf
{
  explicit SceneOf(const std::string &bodies, const std::string &more = "")
    : file(Stroma::ParameterFile::parse("subsection Materials\n"
                                        " subsection gel\n  set Shear modulus = 1\n  set Bulk modulus = 2\n end\n"
                                        " subsection stiff\n  set Shear modulus = 3\n  set Bulk modulus = 7\n end\n"
                                        "end\n"
                                        "subsection Bodies\n" +
                                          bodies + "end\n" + more,
                                        "test.prm"))
    , parameters(file)
    , scene(parameters, MPI_COMM_WORLD)
  {}

  Stroma::ParameterFile file;
  Stroma::Parameters    parameters;
  Stroma::Scene<dim>    scene;
};

/// A body, a box from @p lower to @p upper.
inline std::string
box(const std::string &name, const std::string &lower, const std::string &upper, const std::string &more = "")
{
  return " subsection " + name + "\n  set Lower corner = " + lower + "\n  set Upper corner = " + upper + "\n" + more +
         " end\n";
}

/// A section of one subsection: a support, a load or a probe.
inline std::string
section(const std::string &name, const std::string &subsection, const std::string &entries)
{
  return "subsection " + name + "\n subsection " + subsection + "\n" + entries + " end\nend\n";
}
