#include <stroma/base/expression.h>
#include <stroma/base/silence.h>
#include <stroma/base/text.h>

namespace Stroma
{
  template <int dim>
  void
  SpaceTimeVector<dim>::add(Parameters &p, const std::string &name, const std::string &meaning,
                            const std::string &unit, const bool may_be_free)
  {
    std::string text;
    p.add(name, text, meaning + " [" + unit + "], " + std::to_string(dim) + " expressions of x, y, z, t separated by ;" +
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
        for (unsigned int c = 0; c < dim; ++c)
          if (is_free(c) && !may_be_free)
            throw UserError("'free' is only for displacements");
        value(dealii::Point<dim>(), 0.);
      }
    catch (const std::exception &)
      {
        throw UserError(p.where(name), "'" + name + "' was given as '" + text + "'; it must be " + std::to_string(dim) +
                                         " expressions of x, y, " + (dim == 3 ? "z, " : "") +
                                         "t and the constants, separated by ';'" +
                                         (may_be_free ? ", or 'free' where nothing is prescribed" : ""));
      }
  }

  template <int dim>
  void
  SpaceTimeVector<dim>::set(const std::string &components)
  {
    compile(components, {});
  }

  template <int dim>
  void
  SpaceTimeVector<dim>::compile(const std::string &text, const std::map<std::string, double> &constants)
  {
    texts = split(text, ';');
    if (texts.size() != dim)
      throw UserError("wrong number of components");
    for (unsigned int c = 0; c < dim; ++c)
      if (texts[c] != "free")
        {
          functions[c] = std::make_shared<dealii::FunctionParser<dim>>(1);
          functions[c]->initialize(dim == 2 ? "x,y,t" : "x,y,z,t", texts[c], constants, true);
        }
  }

  template <int dim>
  double
  SpaceTimeVector<dim>::value(const dealii::Point<dim> &X, const double t, const unsigned int component) const
  {
    functions[component]->set_time(t / time);
    return factor * functions[component]->value(X / length);
  }

  template <int dim>
  dealii::Tensor<1, dim>
  SpaceTimeVector<dim>::value(const dealii::Point<dim> &X, const double t) const
  {
    dealii::Tensor<1, dim> result;
    for (unsigned int c = 0; c < dim; ++c)
      if (functions[c])
        result[c] = value(X, t, c);
    return result;
  }

  template class SpaceTimeVector<2>;
  template class SpaceTimeVector<3>;
} // namespace Stroma
