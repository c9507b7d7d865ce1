#include <stroma/base/expression.h>
#include <stroma/base/formula.h>
#include <stroma/base/silence.h>
#include <stroma/base/text.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <set>

namespace Stroma
{
  namespace
  {
    /// What first_not_finite() tells of this rank.
    std::string noted;

    /// "2 expressions of x, y, t and the constants, separated by ';'"
    template <int dim, int n_components>
    std::string
    expected()
    {
      return (n_components == 1 ? "an expression" : std::to_string(n_components) + " expressions") + " of x, y, " +
             (dim == 3 ? "z, " : "") + "t and the constants" + (n_components == 1 ? "" : ", separated by ';'");
    }
  } // namespace

  template <int dim, int n_components>
  void
  SpaceTimeVector<dim, n_components>::add(Parameters &p, const std::string &name, const std::string &meaning,
                                          const std::string &unit, const bool may_be_free)
  {
    std::string text;
    p.add(name, text,
          meaning + " [" + p.file_unit(unit) + "], " + expected<dim, n_components>() +
            (may_be_free ? ", or 'free'" : ""));
    if (text.empty())
      return;
    length      = p.si_factor("m");
    time        = p.si_factor("s");
    length_unit = p.file_unit("m");
    time_unit   = p.file_unit("s");
    factor      = p.si_factor(unit);
    entry       = p.where(name) + ": '" + name + "' (" + shown(text) + ")";
    try
      {
        compile(text, p.constants());
        for (unsigned int c = 0; c < n_components; ++c)
          if (is_free(c) && !may_be_free)
            throw UserError("'free' is only for displacements");
        const auto at_origin = value(dealii::Point<dim>(), 0.);
        if (!mentions("xyzt") && !std::isfinite(at_origin.norm()))
          throw UserError("its value is not finite");
        noted.clear(); // the origin may lie outside the bodies
      }
    catch (const UserError &error)
      {
        throw UserError(p.where(name), "'" + name + "' was given as '" + shown(text) + "': " + error.what() +
                                         "; it must be " + expected<dim, n_components>() +
                                         (may_be_free ? ", or 'free' where nothing is prescribed" : ""));
      }
  }

  template <int dim, int n_components>
  void
  SpaceTimeVector<dim, n_components>::set(const std::string &components)
  {
    compile(components, {});
  }

  template <int dim, int n_components>
  void
  SpaceTimeVector<dim, n_components>::compile(const std::string &text, const std::map<std::string, double> &constants)
  {
    texts = split(text, ';');
    if (texts.size() != n_components)
      throw UserError(std::to_string(texts.size()) + " component" + (texts.size() == 1 ? " is" : "s are") + " given");
    std::set<std::string> names = {"x", "y", "t"};
    if (dim == 3)
      names.insert("z");
    for (const auto &constant : constants)
      names.insert(constant.first);
    for (unsigned int c = 0; c < n_components; ++c)
      if (texts[c] != "free")
        {
          check_formula(texts[c], names);
          try
            {
              const Silence silence;
              functions[c] = std::make_shared<dealii::FunctionParser<dim>>(1);
              functions[c]->initialize(dim == 2 ? "x,y,t" : "x,y,z,t", texts[c], constants, true);
              functions[c]->value(dealii::Point<dim>()); // muParser reads it only now
            }
          catch (const std::exception &)
            {
              throw UserError("in '" + shown(texts[c]) + "' an operand or operator is missing or out of place");
            }
        }
  }

  template <int dim, int n_components>
  bool
  SpaceTimeVector<dim, n_components>::mentions(const std::string &variables) const
  {
    const std::regex variable("\\b[" + variables + "]\\b");
    return std::any_of(texts.begin(), texts.end(), [&](const auto &text) { return std::regex_search(text, variable); });
  }

  template <int dim, int n_components>
  bool
  SpaceTimeVector<dim, n_components>::depends_on_time() const
  {
    return mentions("t");
  }

  template <int dim, int n_components>
  bool
  SpaceTimeVector<dim, n_components>::depends_on_time(const unsigned int component) const
  {
    return std::regex_search(texts[component], std::regex("\\bt\\b"));
  }

  template <int dim, int n_components>
  bool
  SpaceTimeVector<dim, n_components>::depends_on_place() const
  {
    return mentions("xyz");
  }

  template <int dim, int n_components>
  double
  SpaceTimeVector<dim, n_components>::value(const dealii::Point<dim> &X, const double t,
                                            const unsigned int component) const
  {
    functions[component]->set_time(t / time);
    const double value = factor * functions[component]->value(X / length);
    if (!std::isfinite(value))
      note_not_finite(X, t, component);
    return value;
  }

  template <int dim, int n_components>
  void
  SpaceTimeVector<dim, n_components>::note_not_finite(const dealii::Point<dim> &X, const double t,
                                                      const unsigned int component) const
  {
    if (!noted.empty())
      return;
    std::vector<std::string> coordinates;
    for (unsigned int d = 0; d < dim; ++d)
      coordinates.push_back(std::string(1, "xyz"[d]) + " = " + brief(X[d] / length) + " " + length_unit);
    noted = entry + " is not finite at " + join(coordinates, ", ") + ", t = " + brief(t / time) + " " + time_unit +
            (n_components > 1 ? " (component " + std::to_string(component + 1) + ")" : "") +
            "; change it so that it is finite wherever it acts";
  }

  template <int dim, int n_components>
  double
  SpaceTimeVector<dim, n_components>::rate(const dealii::Point<dim> &X, const double t, const unsigned int component,
                                           const double h) const
  {
    const double now = value(X, t, component);
    return (4. * (now - value(X, t - h, component)) - (now - value(X, t - 2. * h, component))) / (2. * h);
  }

  template <int dim, int n_components>
  dealii::Tensor<1, n_components>
  SpaceTimeVector<dim, n_components>::value(const dealii::Point<dim> &X, const double t) const
  {
    dealii::Tensor<1, n_components> result;
    for (unsigned int c = 0; c < n_components; ++c)
      if (functions[c])
        result[c] = value(X, t, c);
    return result;
  }

  std::string
  first_not_finite(const MPI_Comm comm)
  {
    const unsigned int rank = dealii::Utilities::MPI::this_mpi_process(comm);
    const unsigned int n    = dealii::Utilities::MPI::n_mpi_processes(comm);
    const unsigned int with = dealii::Utilities::MPI::min(noted.empty() ? n : rank, comm);
    return with == n ? "" : dealii::Utilities::MPI::broadcast(comm, noted, with);
  }

  void
  forget_not_finite()
  {
    noted.clear();
  }

  template class SpaceTimeVector<2>;
  template class SpaceTimeVector<3>;
  template class SpaceTimeVector<2, 1>;
  template class SpaceTimeVector<3, 1>;
} // namespace Stroma
