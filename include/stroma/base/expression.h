#pragma once

#include <stroma/base/parameters.h>

#include <deal.II/base/function_parser.h>
#include <deal.II/base/mpi.h>
#include <deal.II/base/point.h>

#include <array>
#include <memory>
#include <string>

namespace Stroma
{
  /**
   * A vector of `n_components` functions of place and time, read from one entry of the parameter file: components
   * separated by `;`, each an expression of x, y, z, t and the constants (base/formula.h), in the file's units, or `free`
   * where allowed. A value that is not finite is noted, see first_not_finite().
   */
  template <int dim, int n_components = dim>
  class SpaceTimeVector
  {
  public:
    SpaceTimeVector() = default;

    /// Declares and reads entry @p name. @p unit is that of the components' values. Empty text: not given.
    void add(Parameters &p, const std::string &name, const std::string &meaning, const std::string &unit,
             bool may_be_free);

    /// The same from a text given by the program, in SI.
    void set(const std::string &components);

    bool
    given() const
    {
      return !texts.empty();
    }
    bool
    is_free(const unsigned int component) const
    {
      return !functions[component];
    }

    /// Whether an expression mentions t.
    bool depends_on_time() const;
    /// Whether that of @p component does.
    bool depends_on_time(unsigned int component) const;

    /// Whether an expression mentions x, y or z.
    bool depends_on_place() const;

    /// Value of a component that is not free, in SI; @p X in m, @p t in s.
    double value(const dealii::Point<dim> &X, double t, unsigned int component) const;

    /// Rate of change of a component just before @p t, from values over 2 @p h [s]: of second order in h, and exactly 0 where
    /// nothing changes.
    double rate(const dealii::Point<dim> &X, double t, unsigned int component, double h) const;

    /// Value of all components, 0 for free ones.
    dealii::Tensor<1, n_components> value(const dealii::Point<dim> &X, double t) const;

  private:
    void compile(const std::string &text, const std::map<std::string, double> &constants);
    bool mentions(const std::string &variables) const;
    void note_not_finite(const dealii::Point<dim> &X, double t, unsigned int component) const;

    std::vector<std::string>                                               texts;
    std::string                                                            entry; ///< place and name, for messages
    std::string                                                            length_unit = "m", time_unit = "s";
    std::array<std::shared_ptr<dealii::FunctionParser<dim>>, n_components> functions;
    double                                                                 length = 1., time = 1., factor = 1.;
  };

  /// A number as a function of place and time.
  template <int dim>
  using SpaceTimeScalar = SpaceTimeVector<dim, 1>;

  /// Where and when an expression was first not finite since forget_not_finite(), on the first rank that met one:
  /// entry, place and time in the file's units; "" if all were finite. Collective.
  std::string first_not_finite(MPI_Comm comm);
  void        forget_not_finite();
} // namespace Stroma
