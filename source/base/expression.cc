#include <stroma/base/expression.h>
#include <stroma/base/silence.h>
#include <stroma/base/text.h>

#include <algorithm>
#include <regex>

namespace Stroma
{
  namespace
  {
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
    p.add(name, text, meaning + " [" + unit + "], " + expected<dim, n_components>() +
                        (may_be_free ? ", or 'free'" : ""));
    if (text.empty())
      return;
    length = p.si_factor("m");
    time   = p.si_factor("s");
    factor = p.si_factor(unit);
    try
      {
        const Silence silence;
        compile(text, p.constants());
        for (unsigned int c = 0; c < n_components; ++c)
          if (is_free(c) && !may_be_free)
            throw UserError("'free' is only for displacements");
        value(dealii::Point<dim>(), 0.);
      }
    catch (const std::exception &)
      {
        throw UserError(p.where(name), "'" + name + "' was given as '" + text + "'; it must be " + expected<dim, n_components>() +
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
      throw UserError("wrong number of components");
    for (unsigned int c = 0; c < n_components; ++c)
      if (texts[c] != "free")
        {
          functions[c] = std::make_shared<dealii::FunctionParser<dim>>(1);
          functions[c]->initialize(dim == 2 ? "x,y,t" : "x,y,z,t", texts[c], constants, true);
        }
  }

  template <int dim, int n_components>
  bool
  SpaceTimeVector<dim, n_components>::depends_on_time() const
  {
    static const std::regex t("\\bt\\b");
    return std::any_of(texts.begin(), texts.end(), [](const auto &text) { return std::regex_search(text, t); });
  }

  template <int dim, int n_components>
  double
  SpaceTimeVector<dim, n_components>::value(const dealii::Point<dim> &X, const double t, const unsigned int component) const
  {
    functions[component]->set_time(t / time);
    return factor * functions[component]->value(X / length);
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

  template class SpaceTimeVector<2>;
  template class SpaceTimeVector<3>;
  template class SpaceTimeVector<2, 1>;
  template class SpaceTimeVector<3, 1>;
} // namespace Stroma
