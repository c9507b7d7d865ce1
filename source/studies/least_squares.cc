#include <stroma/base/text.h>
#include <stroma/studies/least_squares.h>

#include <unsupported/Eigen/LevenbergMarquardt>

#include <boost/math/distributions/students_t.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace Stroma::Studies
{
  namespace
  {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();

    /// The variables q of the unknowns.
    class Variables
    {
    public:
      explicit Variables(const std::vector<Unknown> &unknowns)
        : unknowns(unknowns)
      {}

      Eigen::VectorXd
      start() const
      {
        Eigen::VectorXd q(unknowns.size());
        for (unsigned int i = 0; i < unknowns.size(); ++i)
          {
            const double part = (unknowns[i].on_scale(unknowns[i].start) - lower(i)) / width(i);
            q[i]              = std::log(part / (1. - part));
          }
        return q;
      }

      std::vector<double>
      values(const Eigen::VectorXd &q) const
      {
        std::vector<double> values;
        for (unsigned int i = 0; i < unknowns.size(); ++i)
          values.push_back(unknowns[i].from_scale(lower(i) + width(i) * part(q[i])));
        return values;
      }

      /// d(value on its scale)/dq.
      double
      slope(const Eigen::VectorXd &q, const unsigned int i) const
      {
        return width(i) * part(q[i]) * (1. - part(q[i]));
      }

      /// Whether the unknown has gone to within a thousandth of a bound.
      bool
      at_bound(const Eigen::VectorXd &q, const unsigned int i) const
      {
        return std::min(part(q[i]), 1. - part(q[i])) < 1e-3;
      }

    private:
      static double
      part(const double q)
      {
        return 1. / (1. + std::exp(-q));
      }
      double
      lower(const unsigned int i) const
      {
        return unknowns[i].on_scale(unknowns[i].lower);
      }
      double
      width(const unsigned int i) const
      {
        return unknowns[i].on_scale(unknowns[i].upper) - lower(i);
      }

      const std::vector<Unknown> &unknowns;
    };

    /// The model as Eigen's minimiser calls it.
    struct Functor : Eigen::DenseFunctor<double>
    {
      Functor(const Variables &variables, const Model &model, const int n_unknowns, LeastSquares &result)
        : Eigen::DenseFunctor<double>(n_unknowns, model.n_residuals)
        , variables(variables)
        , model(model)
        , result(result)
      {}

      int
      operator()(const Eigen::VectorXd &q, Eigen::VectorXd &residuals) const
      {
        ++result.n_evaluations;
        const Eigen::VectorXd found = model.residuals(variables.values(q));
        if (found.size() > 0)
          residuals = found;
        else if (result.n_evaluations == 1)
          return -1;
        else // longer than any that was taken: the minimiser takes a shorter step
          residuals = Eigen::VectorXd::Constant(values(), 1e100);
        return 0;
      }

      int
      df(const Eigen::VectorXd &q, Eigen::MatrixXd &jacobian) const
      {
        ++result.n_derivatives;
        const Eigen::MatrixXd found = model.derivatives(variables.values(q));
        result.has_derivatives      = found.size() > 0;
        if (!result.has_derivatives)
          return -1;
        jacobian = found;
        for (int i = 0; i < inputs(); ++i)
          jacobian.col(i) *= variables.slope(q, i);
        return 0;
      }

      const Variables &variables;
      const Model     &model;
      LeastSquares    &result;
    };

    /// Pairs that change the data in the same way, and unknowns of which the data say nothing.
    void
    warn(const std::vector<Unknown> &unknowns, LeastSquares &result)
    {
      constexpr double alike = .99;
      const auto      &r     = result.correlation;
      for (unsigned int i = 0; i < unknowns.size(); ++i)
        for (unsigned int j = 0; j < i; ++j)
          if (!(std::abs(r(i, j)) < alike))
            result.warnings.push_back("the data cannot tell '" + unknowns[j].name + "' and '" + unknowns[i].name +
                                      "' apart (correlation " + brief(r(i, j)) +
                                      "); hold one of them, or measure something else besides");
      for (unsigned int i = 0; i < unknowns.size(); ++i)
        {
          const auto &found = result.estimates[i];
          if (found.at_bound)
            result.warnings.push_back("'" + unknowns[i].name + "' has gone to a bound (" + brief(found.value) +
                                      "); its interval means nothing");
          else if (found.lower < unknowns[i].lower && found.upper > unknowns[i].upper)
            result.warnings.push_back("the interval of '" + unknowns[i].name +
                                      "' is wider than its bounds: the data hardly " + "depend on it");
        }
    }

    /// @param jacobian by the unknowns on their scales, at the end
    void
    find_intervals(const std::vector<Unknown> &unknowns, const Eigen::MatrixXd &jacobian, LeastSquares &result)
    {
      const int             n = jacobian.rows(), p = unknowns.size();
      const Eigen::VectorXd lengths = jacobian.colwise().norm().cwiseMax(std::numeric_limits<double>::min());
      const Eigen::MatrixXd unit    = jacobian * lengths.cwiseInverse().asDiagonal();
      const Eigen::MatrixXd inverse = (unit.transpose() * unit).completeOrthogonalDecomposition().pseudoInverse();
      const bool   is_singular = (unit.transpose() * unit).selfadjointView<Eigen::Lower>().eigenvalues()[0] < 1e-12;
      const double t           = n > p ? quantile(boost::math::students_t(n - p), .975) : none;
      result.correlation.resize(p, p);
      for (int i = 0; i < p; ++i)
        for (int j = 0; j < p; ++j)
          result.correlation(i, j) = i == j      ? 1. :
                                     is_singular ? none :
                                                   inverse(i, j) / std::sqrt(inverse(i, i) * inverse(j, j));
      for (int i = 0; i < p; ++i)
        {
          auto        &found  = result.estimates[i];
          const double half   = is_singular ? none : t * result.noise * std::sqrt(inverse(i, i)) / lengths[i];
          const double centre = unknowns[i].on_scale(found.value);
          found.lower         = unknowns[i].from_scale(centre - half);
          found.upper         = unknowns[i].from_scale(centre + half);
        }
    }
  } // namespace

  double
  Unknown::on_scale(const double value) const
  {
    return logarithmic ? std::log(value) : value;
  }

  double
  Unknown::from_scale(const double scaled) const
  {
    return logarithmic ? std::exp(scaled) : scaled;
  }

  double
  Unknown::size(const double value) const
  {
    return logarithmic ? value : std::max(std::abs(value), .01 * (upper - lower));
  }

  bool
  depends(const Eigen::VectorXd &slopes, const double value, const Unknown &unknown)
  {
    const double size_on_scale = unknown.logarithmic ? 1. : unknown.size(value);
    return slopes.cwiseAbs().maxCoeff() * size_on_scale >= 1e-4;
  }

  LeastSquares
  least_squares(const std::vector<Unknown> &unknowns, const Model &model, const unsigned int most)
  {
    namespace LM = Eigen::LevenbergMarquardtSpace;
    LeastSquares                       result;
    const Variables                    variables(unknowns);
    Functor                            functor(variables, model, unknowns.size(), result);
    Eigen::LevenbergMarquardt<Functor> minimiser(functor);
    Eigen::VectorXd                    q = variables.start();
    // To a hundredth of a standard error: the sum of squares then changes by (1e-2)^2 of one residual's.
    minimiser.setFtol(1e-5);
    minimiser.setXtol(1e-5);
    minimiser.setGtol(1e-3);
    minimiser.setMaxfev(most);
    LM::Status status = minimiser.minimizeInit(q);
    while (status == LM::Running || status == LM::NotStarted)
      status = minimiser.minimizeOneStep(q);
    result.converged = status != LM::TooManyFunctionEvaluation && status != LM::UserAsked &&
                       status != LM::ImproperInputParameters;
    const auto values = variables.values(q);
    for (unsigned int i = 0; i < unknowns.size(); ++i)
      result.estimates.push_back({values[i], none, none, variables.at_bound(q, i)});
    const bool has_value = status != LM::UserAsked || !result.has_derivatives;
    if (!has_value || status == LM::ImproperInputParameters)
      return result;
    const int n = model.n_residuals, p = unknowns.size();
    result.noise = n > p ? std::sqrt(minimiser.fvec().squaredNorm() / (n - p)) : none;
    if (!result.has_derivatives)
      return result;
    const Eigen::MatrixXd jacobian = model.derivatives(values);
    result.has_derivatives         = jacobian.size() > 0;
    if (!result.has_derivatives)
      return result;
    find_intervals(unknowns, jacobian, result);
    warn(unknowns, result);
    return result;
  }
} // namespace Stroma::Studies
