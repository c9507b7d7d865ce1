#include <stroma/studies/least_squares.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace Stroma::Studies;

namespace
{
  /// y = a (1 - e^(-b x)) at x = .2, .4, ...
  struct Saturation
  {
    Eigen::VectorXd
    operator()(const std::vector<double> &v) const
    {
      Eigen::VectorXd y(n);
      for (unsigned int i = 0; i < n; ++i)
        y[i] = v[0] * (1. - std::exp(-v[1] * .2 * (i + 1)));
      return y;
    }

    static constexpr unsigned int n = 12;
  };

  Model
  model_of(const std::function<Eigen::VectorXd(const std::vector<double> &)> &curve, const Eigen::VectorXd &data,
           const std::vector<Unknown> &unknowns)
  {
    Model model;
    model.n_residuals = data.size();
    model.residuals   = [=](const std::vector<double> &v) { return Eigen::VectorXd(curve(v) - data); };
    model.derivatives = [=](const std::vector<double> &v) {
      Eigen::MatrixXd J(data.size(), v.size());
      for (unsigned int i = 0; i < v.size(); ++i)
        {
          auto near = v;
          near[i]   = unknowns[i].from_scale(unknowns[i].on_scale(v[i]) + 1e-5);
          J.col(i)  = (curve(near) - curve(v)) / 1e-5;
        }
      return J;
    };
    return model;
  }

  const std::vector<Unknown> two = {{"a", 1., .1, 100., true}, {"b", .2, .01, 30., true}};
} // namespace

TEST(LeastSquares, FindsWhatMadeTheData)
{
  const auto found = least_squares(two, model_of(Saturation(), Saturation()({5., 1.5}), two), 50);
  EXPECT_TRUE(found.converged);
  EXPECT_NEAR(found.estimates[0].value, 5., 1e-3);
  EXPECT_NEAR(found.estimates[1].value, 1.5, 1e-3);
  EXPECT_TRUE(found.warnings.empty());
  EXPECT_LT(found.n_evaluations, 15u);
}

// Of 1000 intervals 950 +- 4 sqrt(950 .05) should hold the true value.
TEST(LeastSquares, IntervalsHoldTheTruthInNineteenOfTwentyCases)
{
  std::mt19937                     random(7);
  std::normal_distribution<double> noise(0., .1);
  std::array<unsigned int, 2>      held{};
  for (unsigned int seed = 0; seed < 1000; ++seed)
    {
      Eigen::VectorXd data = Saturation()({5., 1.5});
      for (auto &y : data)
        y += noise(random);
      const auto found = least_squares(two, model_of(Saturation(), data, two), 50);
      ASSERT_TRUE(found.converged);
      held[0] += found.estimates[0].lower < 5. && 5. < found.estimates[0].upper;
      held[1] += found.estimates[1].lower < 1.5 && 1.5 < found.estimates[1].upper;
    }
  for (const unsigned int n : held)
    EXPECT_NEAR(n, 950., 28.);
}

TEST(LeastSquares, SaysWhatTheDataCannotTellApart)
{
  const auto product = [](const std::vector<double> &v) { return Eigen::VectorXd(Saturation()({v[0] * v[1], 1.5})); };
  const auto found   = least_squares(two, model_of(product, product({5., 1.}), two), 50);
  EXPECT_NEAR(found.estimates[0].value * found.estimates[1].value, 5., 1e-2);
  ASSERT_EQ(found.warnings.size(), 1u);
  EXPECT_NE(found.warnings[0].find("cannot tell 'a' and 'b' apart"), std::string::npos);
  EXPECT_TRUE(std::isnan(found.estimates[0].lower));
}

TEST(LeastSquares, StaysWithinItsBoundsAndSaysSo)
{
  const std::vector<Unknown> bounded = {{"a", 1., .1, 2., true}, {"b", 1., .01, 30., false}};
  const auto found = least_squares(bounded, model_of(Saturation(), Saturation()({5., 1.5}), bounded), 50);
  EXPECT_TRUE(found.estimates[0].at_bound);
  EXPECT_NEAR(found.estimates[0].value, 2., .01);
  EXPECT_FALSE(found.warnings.empty());
}

TEST(LeastSquares, AStepWithoutAModelIsShortened)
{
  const auto curve   = [](const std::vector<double> &v) { return v[1] > 3. ? Eigen::VectorXd() : Saturation()(v); };
  auto       model   = model_of(Saturation(), Saturation()({5., 2.}), two);
  const auto whole   = model.residuals;
  bool       refused = false;
  model.residuals    = [&](const std::vector<double> &v) {
    refused |= curve(v).size() == 0;
    return curve(v).size() == 0 ? Eigen::VectorXd() : whole(v);
  };
  const std::vector<Unknown> far   = {{"a", 5., .1, 100., true}, {"b", .02, .01, 30., true}};
  const auto                 found = least_squares(far, model, 80);
  EXPECT_NEAR(found.estimates[1].value, 2., 1e-2);
  EXPECT_TRUE(refused);
}

// Derivatives fail away from the start: the best so far is left, with its noise and without intervals.
TEST(LeastSquares, EndsWithTheBestWithoutDerivatives)
{
  auto       model       = model_of(Saturation(), Saturation()({5., 1.5}), two);
  const auto derivatives = model.derivatives;
  model.derivatives      = [=](const std::vector<double> &v) {
    const bool at_start = std::abs(v[0] / two[0].start - 1.) < 1e-6 && std::abs(v[1] / two[1].start - 1.) < 1e-6;
    return at_start ? derivatives(v) : Eigen::MatrixXd();
  };
  const auto found = least_squares(two, model, 50);
  EXPECT_FALSE(found.converged);
  EXPECT_FALSE(found.has_derivatives);
  EXPECT_TRUE(std::isnan(found.estimates[0].lower));
  const double at_start = model.residuals({two[0].start, two[1].start}).squaredNorm(),
               at_end   = model.residuals({found.estimates[0].value, found.estimates[1].value}).squaredNorm();
  EXPECT_LT(at_end, at_start);
  EXPECT_NEAR(found.noise, std::sqrt(at_end / (Saturation::n - 2)), 1e-9);
}

// Data proportional to a modulus of 1e9 Pa: by the number itself their slope is 1e-9.
TEST(LeastSquares, DependenceIsOfAChangeAsLargeAsTheValue)
{
  const Unknown linear{"E", 1e9, 1e8, 1e10, false}, logarithmic{"E", 1e9, 1e8, 1e10, true},
    angle{"a", 0., -1., 1., false};
  EXPECT_TRUE(depends(Eigen::VectorXd::Constant(1, 1e-9), 1e9, linear));
  EXPECT_FALSE(depends(Eigen::VectorXd::Constant(1, 1e-14), 1e9, linear));
  EXPECT_TRUE(depends(Eigen::VectorXd::Constant(1, 1.), 1e9, logarithmic));
  EXPECT_FALSE(depends(Eigen::VectorXd::Constant(1, 1e-5), 1e9, logarithmic));
  EXPECT_TRUE(depends(Eigen::VectorXd::Constant(1, 1.), 0., angle));
}
