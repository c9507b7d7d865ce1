#pragma once

#include "method_fixture.h"

#include <gtest/gtest.h>

#include <iostream>

inline const std::string gel =
  "subsection Materials\n subsection gel\n  set Law = neo-Hookean\n  set Young's modulus = 1000\n"
  "  set Poisson's ratio = 0.3\n end\nend\n";

/// A block 2 x 1 with its upper side in y = 0 and a rigid body, both by entries.
inline std::string
block(const std::string &rigid, const std::string &supports, const std::string &loads, const std::string &type,
      const std::string &mpm, const std::string &top = "0")
{
  return "set Dimension = 2\n" + gel +
         "subsection Bodies\n subsection block\n  set Shape = box\n  set Lower corner = -1, -1\n  set Upper corner = 1, " +
         top + "\n end\n subsection body\n  set Rigid = true\n" + rigid + " end\nend\nsubsection Supports\n" +
         supports + "end\n" +
         (loads.empty() ? "" :
                          "subsection Loads\n subsection load\n  set Where = body body\n" + loads + " end\nend\n") +
         "subsection Contact\n subsection touch\n  set Type = " + type + "\n end\nend\n" +
         "subsection Newton\n set Displacement tolerance = 1e-9\n set Energy tolerance = 1e-14\nend\n"
         "subsection Linear solver\n set Tolerance = 1e-11\nend\n"
         "subsection FEM\n set Cells = 16, 8\n set Degree = 1\nend\n"
         "subsection MPM\n set Cells = 16, 8\n" +
         mpm + "end\n";
}

inline const std::string circle  = "  set Shape = ball\n  set Centre = 0, 1\n  set Radius = 1\n";
inline const std::string clamped = " subsection bottom\n  set Where = side y-min\n  set Type = clamp\n end\n";
inline const std::string gauss   = " set Points at = Gauss points\n";

inline std::string
driven(const std::string &entries)
{
  return " subsection drive\n  set Where = body body\n" + entries + " end\n";
}

/// Results of mpm over those of fem, where the points are those of quadrature.
inline void
expect_alike(const std::string &text, const std::vector<std::string> &names, const unsigned int n_steps)
{
  if (!MethodFixture::has("fem"))
    return;
  MethodFixture mpm(text, "mpm"), fem(text, "fem");
  ASSERT_TRUE(mpm.advance(0., 1., n_steps));
  ASSERT_TRUE(fem.advance(0., 1., n_steps));
  for (const auto &name : names)
    {
      std::cout << name << ": " << mpm.scalars().at(name) << ", " << fem.scalars().at(name) << std::endl;
      EXPECT_NEAR(mpm.scalars().at(name), fem.scalars().at(name), 1e-5 * std::abs(fem.scalars().at(name)) + 1e-9)
        << name;
    }
}
