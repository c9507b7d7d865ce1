#pragma once

#include <Eigen/Dense>

#include <functional>
#include <string>
#include <vector>

namespace Stroma::Studies
{
  /// A number to be found, between two bounds.
  struct Unknown
  {
    std::string name;
    double      start = 0., lower = 0., upper = 0.;
    bool        logarithmic = true; ///< steps and intervals are those of its logarithm
    std::string where       = {};   ///< in the file

    /// The number on its scale, and back.
    double on_scale(double value) const;
    double from_scale(double scaled) const;

    /// How large a number is, of which a change for derivatives is a small part: never zero.
    double size(double value) const;
  };

  /**
   * Whether a change of @p value as large as its size would change a residual by 1e-4 or more.
   * @param slopes of the residuals, by the unknown on its scale
   */
  bool depends(const Eigen::VectorXd &slopes, double value, const Unknown &unknown);

  /// What was found of an unknown.
  struct Estimate
  {
    double value  = 0.;
    double lower  = 0.,
           upper  = 0.; ///< of the interval that holds the true value with 95 % confidence; not a number: unknown
    bool at_bound = false;
  };

  /// Residuals of the model with given unknowns, and their derivatives by the unknowns on their scales.
  struct Model
  {
    unsigned int n_residuals = 0;

    /// Differences of model and data, each over its standard deviation or of a common one; empty: the model has none there.
    std::function<Eigen::VectorXd(const std::vector<double> &)> residuals;
    /// One column an unknown, at values whose residuals were found before; empty: the model has none there.
    std::function<Eigen::MatrixXd(const std::vector<double> &)> derivatives;
  };

  struct LeastSquares
  {
    std::vector<Estimate> estimates;
    Eigen::MatrixXd       correlation;        ///< of the estimates
    double                noise         = 0.; ///< standard deviation of the residuals
    unsigned int          n_evaluations = 0, n_derivatives = 0;
    bool                  converged = false;
    bool has_derivatives = true; ///< at the estimates; without them the search ends, and there are no intervals

    /// Names of pairs of unknowns that the data cannot tell apart, with their correlation.
    std::vector<std::string> warnings;
  };

  /**
   * The unknowns that make the sum of squared residuals least: the Levenberg-Marquardt method of MINPACK (More 1978) as Eigen
   * keeps it, on variables q in which value = lower + (upper - lower) / (1 + e^-q) on the unknown's scale, so that every step stays
   * within the bounds. Without a model at a step, it is shortened. Without derivatives the search
   * ends with the best so far.
   *
   * Confidence intervals are those of the linear model at the end (Bates & Watts 1988, section 1.3): estimate +- t s sqrt(C_ii) on
   * the scale, C = (J^T J)^-1, s^2 the sum of squares over n - p, t Student's quantile for n - p. Without degrees of freedom there
   * are none.
   *
   * @return at the start if the model has no value there; not converged after @p most evaluations
   */
  LeastSquares least_squares(const std::vector<Unknown> &unknowns, const Model &model, unsigned int most);
} // namespace Stroma::Studies
