#include <stroma/base/errors.h>
#include <stroma/studies/means.h>
#include <stroma/studies/missing_results.h>
#include <stroma/studies/plan.h>
#include <stroma/studies/study_table.h>

#include <gtest/gtest.h>

#include <cmath>

using namespace Stroma;
using namespace Stroma::Studies;

namespace
{
  StudyPlan
  plan_of(const std::string &study)
  {
    return read_plan(ParameterFile::parse(
                       "set Dimension = 2\nsubsection MPM\nset Cells = 4, 4\nend\nsubsection Study\n" + study + "end\n",
                       "study.prm"),
                     MPI_COMM_WORLD);
  }

  std::string
  message_of(const std::string &study)
  {
    try
      {
        plan_of(study);
      }
    catch (const UserError &error)
      {
        return error.what();
      }
    return "";
  }

  const std::string resolution =
    "subsection resolution\nset Parameter = Constants/cells\nset Values = 8, 16, 32\nend\n";
} // namespace

TEST(Plan, AssignmentsKeepCommasOfTheirValues)
{
  EXPECT_EQ(assignments("Method = fem, MPM/Cells = 8, 8, FEM/Degree = 2"),
            (std::vector<std::string>{"Method = fem", "MPM/Cells = 8, 8", "FEM/Degree = 2"}));
}

TEST(Plan, NamesAndNumbersOfRunsAreLimited)
{
  for (const std::string name : {"..", ".", "a,b", "a\"b", "a;b"})
    EXPECT_NE(
      message_of("subsection Cases\nsubsection " + name + "\nend\nend\n" + resolution).find("the name of case '"),
      std::string::npos)
      << name;
  std::string many;
  for (const std::string name : {"a", "b", "c"})
    {
      many += "subsection " + name + "\nset Parameter = Constants/" + name + "\nset Values = 1";
      for (unsigned int i = 2; i <= 100; ++i)
        many += ", " + std::to_string(i);
      many += "\nend\n";
    }
  EXPECT_NE(message_of(many).find("more than 10,000 runs"), std::string::npos) << message_of(many);
  const auto plan = plan_of("subsection file\nset Parameter = Bodies/a/File\nset Values = ../../x, y\nend\n");
  EXPECT_EQ(plan.runs[0].folder, "File=.._.._x");
  EXPECT_NE(message_of("subsection file\nset Parameter = Bodies/a/File\nset Values = " + std::string(300, 'a') +
                       "\nend\n")
              .find("more than 200 letters"),
            std::string::npos);
}

TEST(Plan, AllCombinationsLastFastest)
{
  const auto plan = plan_of("subsection reset\nset Parameter = MPM/Grid reset\nset Values = never, always\nend\n" +
                            resolution);
  ASSERT_EQ(plan.runs.size(), 6u);
  EXPECT_EQ(plan.runs[4].folder, "Grid_reset=always,cells=16");
  EXPECT_EQ(plan.runs[4].values, (std::vector<std::string>{"always", "16"}));
  EXPECT_EQ(plan.runs[4].curve, "Grid reset=always");
  EXPECT_EQ(plan.runs[4].coarser, 3);
  EXPECT_EQ(plan.runs[3].coarser, -1);
  EXPECT_EQ(plan.runs[4].axis_number, 16.);
}

TEST(Plan, CasesHaveTheirOwnParameters)
{
  const auto plan = plan_of(
    "subsection Cases\nsubsection Q1\nset Set = Method = fem\nend\nsubsection points\nend\nend\n" + resolution +
    "subsection degree\nset Parameter = FEM/Degree\nset Values = 1, 2\nset Only = Q1\nend\n");
  ASSERT_EQ(plan.runs.size(), 6u + 3u);
  EXPECT_EQ(plan.runs[1].set, (std::vector<std::string>{"Method = fem", "Constants/cells=8", "FEM/Degree=2"}));
  EXPECT_EQ(plan.runs[6].folder, "points,cells=8");
  EXPECT_EQ(plan.runs[6].values, (std::vector<std::string>{"8", "-"}));
  EXPECT_EQ(plan.runs[8].coarser, 7);
}

TEST(Plan, ValuesThatHoldCommasStandInParentheses)
{
  const auto plan = plan_of("subsection resolution\nset Parameter = MPM/Cells\n"
                            "set Values = (4, 4), (8,8), (8, 4), 2*(1+1), max(2, 3)\nend\n");
  ASSERT_EQ(plan.runs.size(), 5u);
  EXPECT_EQ(plan.runs[1].set, (std::vector<std::string>{"MPM/Cells=8,8"}));
  EXPECT_EQ(plan.runs[1].axis_number, 8.);
  EXPECT_TRUE(std::isnan(plan.runs[2].axis_number));
  EXPECT_EQ(plan.runs[2].folder, "Cells=8,_4");
  EXPECT_EQ(plan.runs[3].values[0], "2*(1+1)");
  EXPECT_EQ(plan.runs[4].values[0], "max(2, 3)");
}

TEST(Plan, ValuesThatGrowByAFactorAreNumbers)
{
  const auto numbers = [](const std::string &values) {
    std::vector<double> found;
    for (const auto &run :
         plan_of("subsection cells\nset Parameter = MPM/Cells\nset Values = " + values + "\nend\n").runs)
      found.push_back(run.axis_number);
    return found;
  };
  EXPECT_EQ(numbers("(5, 10), (10, 20), (40, 80)"), (std::vector<double>{5., 10., 40.}));
  EXPECT_EQ(numbers("(0.3, 0.1, 2), (0.9, 0.3, 6)"), (std::vector<double>{.3, .9}));
  EXPECT_EQ(numbers("0, 1"), (std::vector<double>{0., 1.}));
  for (const std::string unlike :
       {"(5, 10), (10, 10)", "(5, 10), (10, 30)", "(5, 10), (10, 20, 40)", "(0, 10), (0, 20)"})
    EXPECT_TRUE(std::isnan(numbers(unlike)[0])) << unlike;
}

TEST(Plan, ResultsThatNoRunHasAreMissed)
{
  const auto missed = [](const std::string &text, const std::vector<std::string> &statuses,
                         const std::map<std::string, double> &results) {
    const auto             plan = plan_of(text);
    std::vector<RunRecord> records(plan.runs.size());
    for (std::size_t i = 0; i < statuses.size(); ++i)
      {
        records[i].status  = statuses[i];
        records[i].results = results;
      }
    return missing_result(plan, records);
  };
  const std::string wanted      = "set Results = a, b\n",
                    two_methods = "subsection m\nset Parameter = Method\nset Values = fem, mpm\nend\n";
  EXPECT_EQ(missed(wanted + resolution, {"finished"}, {{"a", 1.}}), "b"); // the others differ in numbers only
  EXPECT_EQ(missed(wanted + resolution, {"finished"}, {{"a", 1.}, {"b", std::nan("")}}), "");
  EXPECT_EQ(missed(wanted + resolution, {"failed: why"}, {{"a", 1.}}), "");
  EXPECT_EQ(missed(wanted + two_methods, {"finished"}, {{"a", 1.}}), ""); // mpm may have it
  EXPECT_EQ(missed(wanted + two_methods, {"finished", "failed: why"}, {{"a", 1.}}), "b");
  EXPECT_EQ(missed(resolution, {"finished"}, {{"a", 1.}}), ""); // nobody asked for reaction_force_y_N
  EXPECT_EQ(missed("set Results = free_parts, apparent_modulus_y_Pa\n" + resolution, {"finished"},
                   {{"nominal_stress_y_Pa", 0.}}),
            "");
  EXPECT_EQ(missed("set Results = apparent_modulus_z_Pa\n" + resolution, {"finished"}, {{"nominal_stress_y_Pa", 0.}}),
            "apparent_modulus_z_Pa");
}

TEST(Plan, FoldersStayInsideTheStudys)
{
  const auto cases = [](const std::string &name) {
    return "subsection Cases\nsubsection " + name +
           "\nend\nsubsection other\nend\nend\nsubsection n\nset Parameter = Constants/n\nset Values = 1, 2\nset Only = other\n"
           "end\n";
  };
  for (const std::string name : {"reference", "states", "study.csv"})
    EXPECT_EQ(message_of(cases(name)), "study.prm:5: two runs would be called '" + name +
                                         "'; rename a case, or remove a value that is there twice");
}

TEST(Plan, FieldsWithOrWithoutTheirUnit)
{
  const std::string error = resolution + "subsection Error\nset Against = exact\nset Fields = ";
  EXPECT_EQ(plan_of(error + "displacement, von_mises\nend\n").error.compare.fields,
            (std::vector<std::string>{"displacement_m", "von_mises_Pa"}));
  EXPECT_EQ(
    message_of(error + "stress\nend\n"),
    "study.prm:12: 'Fields' names 'stress'; it must be of: displacement_m, displacement_gradient, velocity_m_per_s, "
    "velocity_gradient_per_s, von_mises_Pa, pressure_Pa, cauchy_stress_Pa");
}

TEST(Plan, BadStudies)
{
  EXPECT_EQ(message_of(""),
            "study.prm:5: nothing to vary; add subsections with 'Parameter' and 'Values' to section Study");
  EXPECT_EQ(message_of(resolution + "set Repeet = 2\n"),
            "study.prm:10: 'Repeet' is not a parameter of section 'Study' of this scene; known here: Repeat, Results, "
            "Reference, Mean over, Repeat below");
  EXPECT_EQ(
    message_of(resolution + "subsection Error\nset Against = reference\nend\n"),
    "study.prm:5: 'Against = reference' needs a section Reference; say there by 'Set' how the reference differs from "
    "the scene");
  EXPECT_EQ(message_of(resolution +
                       "subsection Error\nset Against = exact\nset Fields = pressure_Pa\nset Norm = H1\nend\n"),
            "study.prm:13: 'Norm = H1' is for 'Fields = displacement_m' or 'velocity_m_per_s'; choose L2 or max");
  EXPECT_EQ(message_of("subsection Cases\nsubsection a\nset Set = fem\nend\nend\n" + resolution),
            "study.prm:8: 'Set' was given as 'fem'; it must be a list of Section/name = value");
  EXPECT_EQ(message_of(
              "subsection Cases\nsubsection a\nend\nend\nsubsection n\nset Parameter = Constants/n\nset Values = 1\n"
              "set Only = b\nend\n"),
            "study.prm:13: 'Only' names 'b'; it must be of the cases: a");
  EXPECT_EQ(message_of(resolution + "set Reference = 1, 2\n"),
            "study.prm:10: 'Reference' has 2 values for 3 runs; give one a run");
}

TEST(Means, StandardErrorsOverTheValuesOfOneEntry)
{
  const auto             plan = plan_of("set Results = speed\nset Mean over = seeds\n" + resolution +
                                        "subsection seeds\nset Parameter = Migration/cell/Seed\nset Values = 1, 2, 3\nend\n");
  std::vector<RunRecord> records(plan.runs.size());
  for (std::size_t i = 0; i < records.size(); ++i)
    {
      records[i].status           = i == 8 ? "failed: so" : "finished";
      records[i].results["speed"] = i < 3 ? 1. + i : 10. * i;
    }
  const auto means = means_of(plan, records);
  ASSERT_EQ(means.size(), 3u);
  EXPECT_EQ(means[0].n_runs, 3u);
  EXPECT_NEAR(means[0].results[0], 2., 1e-14);
  EXPECT_NEAR(means[0].errors[0], std::sqrt(1. / 3.), 1e-14);
  EXPECT_EQ(means[2].n_runs, 2u) << "without the run that failed";
  EXPECT_NEAR(means[2].results[0], 65., 1e-12);
  const auto rows = mean_rows(plan, means);
  EXPECT_EQ(rows[0], (std::vector<std::string>{"Constants/cells", "speed", "standard_error", "runs"}));
  EXPECT_EQ(rows[1], (std::vector<std::string>{"8", "2", "0.58", "3"}));
  EXPECT_EQ(
    message_of("set Mean over = seed\n" + resolution),
    "study.prm:6: 'Mean over' was given as 'seed'; it must be one of the sections that vary an entry: resolution");
}

TEST(Plan, OrdersWithinACurve)
{
  const auto plan = plan_of(
    "set Results =\nsubsection reset\nset Parameter = MPM/Grid reset\nset Values = never, always\nend\n" + resolution +
    "subsection Error\nset Against = exact\nend\n");
  std::vector<RunRecord> records(plan.runs.size());
  for (std::size_t i = 0; i < records.size(); ++i)
    {
      records[i].status                   = "finished";
      records[i].wall_times               = {1. + i, 3. + i, 2. + i};
      records[i].cpu_times                = {4. + i, 8. + i, 7. + i};
      records[i].peak_memory_bytes        = 12'340'000;
      records[i].errors["displacement_m"] = {{std::pow(plan.runs[i].axis_number, i < 3 ? -2. : -1.), std::nan(""), 0.}};
    }
  EXPECT_TRUE(std::isnan(order_of(plan, records, 0, "displacement_m")));
  EXPECT_NEAR(order_of(plan, records, 2, "displacement_m"), 2., 1e-12);
  EXPECT_TRUE(std::isnan(order_of(plan, records, 3, "displacement_m")));
  EXPECT_NEAR(order_of(plan, records, 4, "displacement_m"), 1., 1e-12);
  const auto rows = study_rows(plan, records);
  EXPECT_EQ(rows[0],
            (std::vector<std::string>{"Grid reset", "cells", "error", "order", "steps", "newton", "cg", "wall_time_s",
                                      "spread_s", "times", "cpu_time_s", "peak_memory_MB", "status"}));
  EXPECT_EQ(rows[5], (std::vector<std::string>{"always", "16", "6.2500e-02", "1.00", "0", "0", "0", "6.000", "2.000",
                                               "3", "11.000", "12.3", "finished"}));
}
