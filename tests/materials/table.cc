// Reading materials: pairs of elastic constants, the choice of the law, messages.

#include "points.h"

#include <stroma/base/parameters.h>

#include <stroma/materials/table.h>

#include <gtest/gtest.h>

using namespace Points;
using Stroma::ParameterFile;
using Stroma::Parameters;
using Stroma::UserError;
using Stroma::Materials::create;
using Stroma::Materials::PlaneModel;

namespace
{
  ElasticConstants
  read(const std::string &text)
  {
    const auto       file = ParameterFile::parse(text, "test.prm");
    Parameters       p(file);
    ElasticConstants constants;
    constants.add(p);
    p.finish();
    return constants;
  }

  /// The message of the UserError that @p action throws.
  template <typename Action>
  std::string
  message(const Action &action)
  {
    try
      {
        action();
      }
    catch (const UserError &error)
      {
        return error.what();
      }
    return "no error";
  }

  std::string
  message_of(const std::string &text)
  {
    return message([&] { read(text); });
  }

  std::unique_ptr<Material>
  material(const std::string &entries, const PlaneModel plane = PlaneModel::strain)
  {
    const auto file = ParameterFile::parse("subsection collagen\n" + entries + "end\n", "test.prm");
    Parameters p(file);
    const auto section = p.section("collagen");
    auto       law     = create(p, plane);
    p.finish();
    return law;
  }
} // namespace

TEST(ElasticConstants, AllPairsGiveTheSame)
{
  const std::string E = "set Young's modulus = 1200\n", nu = "set Poisson's ratio = .2\n",
                    mu = "set Shear modulus = 500\n", kappa = "set Bulk modulus = 2000/3\n";
  for (const auto &text : {E + nu, E + mu, E + kappa, nu + mu, nu + kappa, mu + kappa})
    {
      const auto constants = read(text);
      EXPECT_NEAR(constants.mu, 500., 1e-10) << text;
      EXPECT_NEAR(constants.kappa, 2000. / 3., 1e-10) << text;
      EXPECT_NEAR(constants.lambda(), 1000. / 3., 1e-10) << text;
      EXPECT_NEAR(constants.p_wave_modulus(), 4000. / 3., 1e-10) << text;
    }
}

TEST(ElasticConstants, FollowTheUnitsOfTheFile)
{
  const auto constants = read("subsection Units\nset Stress = kPa\nend\n"
                              "set Young's modulus = 1.2\nset Poisson's ratio = .2\n");
  EXPECT_NEAR(constants.mu, 500., 1e-10);
}

TEST(ElasticConstants, NegativePoissonsRatioIsAllowed)
{
  const auto constants = read("set Young's modulus = 1\nset Poisson's ratio = -.9\n");
  EXPECT_NEAR(constants.mu, 5., 1e-12);
  EXPECT_NEAR(constants.kappa, 1. / 8.4, 1e-12);
}

TEST(ElasticConstants, NeedsExactlyTwo)
{
  const std::string rule = "a material needs exactly two of: Young's modulus, Poisson's ratio, Shear modulus, Bulk "
                           "modulus; given: ";
  EXPECT_EQ(message_of(""), "test.prm: " + rule + "none");
  EXPECT_EQ(message_of("set Bulk modulus = 1\n"), "test.prm: " + rule + "Bulk modulus");
  EXPECT_EQ(message_of("set Bulk modulus = 1\nset Poisson's ratio = .3\nset Young's modulus = 1\n"),
            "test.prm: " + rule + "Young's modulus, Poisson's ratio, Bulk modulus");
  EXPECT_EQ(message([] { material("set Bulk modulus = 1\n"); }), "test.prm:1: " + rule + "Bulk modulus");
}

TEST(ElasticConstants, RefusesPairsThatDoNotFit)
{
  EXPECT_EQ(message_of("set Shear modulus = 1\nset Young's modulus = 3\n"),
            "test.prm:2: 'Young's modulus' and 'Shear modulus' do not fit together: 'Young's modulus' must be less "
            "than 3 times 'Shear modulus'; change one of them");
  EXPECT_EQ(message_of("set Young's modulus = 9.5\nset Bulk modulus = 1\n"),
            "test.prm:1: 'Young's modulus' and 'Bulk modulus' do not fit together: 'Young's modulus' must be less "
            "than 9 times 'Bulk modulus'; change one of them");
  EXPECT_GT(read("set Shear modulus = 1\nset Young's modulus = 2.99\n").kappa, 0.);
  EXPECT_GT(read("set Bulk modulus = 1\nset Young's modulus = 8.99\n").mu, 0.);
}

TEST(ElasticConstants, RefusesValuesOutOfRange)
{
  for (const std::string ratio : {"-1", ".5", ".7", "-3"})
    EXPECT_EQ(
      message_of("set Shear modulus = 1\nset Poisson's ratio = " + ratio + "\n").rfind("test.prm:2: 'Poisson", 0), 0u)
      << ratio;
  for (const std::string name : {"Young's modulus", "Shear modulus", "Bulk modulus"})
    for (const std::string value : {"0", "-1"})
      EXPECT_EQ(
        message_of("set " + name + " = " + value + "\nset Poisson's ratio = .3\n").rfind("test.prm:1: '" + name, 0), 0u)
        << name;
}

TEST(ElasticConstants, NothingNeedsToBeGivenInADocument)
{
  const auto       file = ParameterFile::parse("", "template");
  Parameters       p(file, Parameters::Mode::document);
  ElasticConstants constants;
  EXPECT_NO_THROW(constants.add(p));
  for (const std::string name : {"Young's modulus", "Poisson's ratio", "Shear modulus", "Bulk modulus"})
    EXPECT_EQ(p.values().count(name), 1u) << name;
}

TEST(Table, BuildsTheChosenLaw)
{
  const std::string moduli = "set Shear modulus = 520.8\nset Bulk modulus = 1041.6\n";
  const auto        F      = diagonal(.95, 1.1, 1.);
  const auto        neo = material(moduli), linear = material("set Law = linear elastic\n" + moduli);
  EXPECT_EQ(neo->name(), "neo-Hookean");
  EXPECT_EQ(material("set Law = neo-Hookean\n" + moduli)->name(), "neo-Hookean");
  EXPECT_EQ(linear->name(), "linear elastic");
  EXPECT_NEAR(respond(*neo, {F}).psi[0],
              .5 * 1041.6 * std::pow(std::log(1.045), 2) + 260.4 * (std::pow(1.045, -2. / 3.) * 3.1125 - 3.), 1e-10);
  EXPECT_NEAR(respond(*linear, {F}).tau[0][2][2], 694.4 * .5 * (3.1125 - 3.), 1e-10);
  EXPECT_NEAR(neo->p_wave_modulus(), 1736., 1e-9);
}

// Integrated in time; without that it is Hooke's law of small strains.
TEST(Table, HypoelasticIsALawInRates)
{
  const std::string moduli = "set Law = hypoelastic\nset Shear modulus = 520.8\nset Bulk modulus = 1041.6\n";
  const auto        law    = material(moduli);
  EXPECT_TRUE(law->is_rate_form());
  EXPECT_FALSE(material("set Shear modulus = 520.8\nset Bulk modulus = 1041.6\n")->is_rate_form());
  const auto response = respond(*law->small_strain(), {diagonal(.95, 1.1, 1.)});
  EXPECT_NEAR(response.tau[0][0][0], 694.4 * .05 - 2. * 520.8 * .05, 1e-10);
  EXPECT_NEAR(response.tau[0][1][1], 694.4 * .05 + 2. * 520.8 * .1, 1e-10);
  EXPECT_TRUE(material(moduli, PlaneModel::stress)->is_rate_form());
}

TEST(Table, LawsSayWhatTheyAre)
{
  const std::string moduli = "set Shear modulus = 520.8\nset Bulk modulus = 1041.6\n";
  const auto        linear = material("set Law = linear elastic\n" + moduli);
  EXPECT_NE(linear->meaning().find("St. Venant-Kirchhoff"), std::string::npos);
  EXPECT_NE(linear->small_strain()->meaning().find("Hooke's law of small strains"), std::string::npos);
  EXPECT_NE(material(moduli)->meaning().find("kappa/2 (ln J)^2"), std::string::npos);
}

TEST(Table, WrapsForPlaneStress)
{
  const std::string moduli = "set Shear modulus = 520.8\nset Bulk modulus = 1041.6\n";
  const auto        F      = diagonal(.95, 1.1, 1.);
  const auto        law    = material(moduli, PlaneModel::stress);
  EXPECT_EQ(law->name(), "neo-Hookean");
  EXPECT_LT(respond(*law, {F}).F33[0], .99);
  EXPECT_EQ(respond(*law, {F}).tau[0][2][2], 0.);
  EXPECT_GT(respond(*material(moduli), {F}).tau[0][2][2], 1.);
}

TEST(Table, UnknownLawListsTheKnownOnes)
{
  EXPECT_EQ(
    message([] { material("set Law = Mooney\n"); }),
    "test.prm:2: 'Law' was given as 'Mooney'; it must be one of: neo-Hookean, linear elastic, hypoelastic, fluid, Prony, Ogden");
}

TEST(Table, DocumentsItsEntries)
{
  const auto file = ParameterFile::parse("", "template");
  for (const auto plane : {PlaneModel::strain, PlaneModel::stress})
    {
      Parameters p(file, Parameters::Mode::document);
      EXPECT_NO_THROW(create(p, plane));
      EXPECT_NE(p.print(true).find("set Law"), std::string::npos);
      EXPECT_NE(p.print(true).find("# set Poisson's ratio"), std::string::npos);
    }
}
