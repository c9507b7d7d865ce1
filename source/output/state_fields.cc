#include <stroma/output/state_fields.h>
#include <stroma/solid/stress_measures.h>

#include <deal.II/base/exceptions.h>

#include <algorithm>

namespace Stroma::Output
{
  namespace
  {
    using S = PointState;

    unsigned int
    scalar(unsigned int)
    {
      return 1;
    }

    unsigned int
    vector(const unsigned int dim)
    {
      return dim;
    }

    unsigned int
    tensor(const unsigned int dim)
    {
      return dim * dim;
    }

    unsigned int
    symmetric(unsigned int)
    {
      return 6;
    }

    void
    copy(const dealii::Tensor<1, 3> &a, const unsigned int dim, double *v)
    {
      for (unsigned int i = 0; i < dim; ++i)
        v[i] = a[i];
    }

    void
    copy(const dealii::Tensor<2, 3> &a, const unsigned int dim, double *v)
    {
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          *v++ = a[i][j];
    }

    void
    copy(const dealii::SymmetricTensor<2, 3> &a, double *v)
    {
      for (unsigned int i = 0; i < 6; ++i)
        v[i] = a.access_raw_entry(i);
    }

    bool
    is_called(const StateField &field, const std::string &name)
    {
      return field.name == name || field.full_name() == name;
    }
  } // namespace

  const std::vector<StateField> &
  state_fields()
  {
    using N                                    = unsigned int;
    static const std::vector<StateField> table = {
      {"displacement", "m", vector, [](const S &s, N dim, double *v) { copy(s.u, dim, v); }},
      {"displacement_gradient", "", tensor, [](const S &s, N dim, double *v) { copy(s.u_gradient, dim, v); }},
      {"velocity", "m_per_s", vector, [](const S &s, N dim, double *v) { copy(s.v, dim, v); }},
      {"velocity_gradient", "per_s", tensor, [](const S &s, N dim, double *v) { copy(s.v_gradient, dim, v); }},
      {"von_mises", "Pa", scalar, [](const S &s, N, double *v) { *v = Solid::von_mises(s.cauchy); }},
      {"pressure", "Pa", scalar, [](const S &s, N, double *v) { *v = s.pressure; }},
      {"cauchy_stress", "Pa", symmetric, [](const S &s, N, double *v) { copy(s.cauchy, v); }},
      {"J", "", scalar, [](const S &s, N, double *v) { *v = s.J; }},
      {"material", "", scalar, [](const S &s, N, double *v) { *v = s.material; }},
      {"volume", "m3", scalar, [](const S &s, N, double *v) { *v = s.V0; }},
      {"fixed", "", scalar, [](const S &s, N, double *v) { *v = s.is_fixed; }},
      {"kernel_sum", "", scalar, [](const S &s, N, double *v) { *v = s.kernel_sum; }},
      {"density", "kg_per_m3", scalar, [](const S &s, N, double *v) { *v = s.density; }},
      {"degradation_factor", "", scalar, [](const S &s, N, double *v) { *v = s.intact; }}};
    return table;
  }

  StateFields::StateFields(const unsigned int dim, const std::vector<std::string> &names)
    : dim(dim)
  {
    for (const auto &name : names)
      {
        const auto &table = state_fields();
        const auto  field = std::find_if(table.begin(), table.end(), [&](const auto &f) { return is_called(f, name); });
        AssertThrow(field != table.end(), dealii::ExcMessage("points have no field " + name));
        chosen.push_back(&*field);
        n_values += field->components(dim);
      }
  }

  std::vector<std::string>
  StateFields::in_order(const std::vector<std::string> &names)
  {
    std::vector<std::string> ordered;
    for (const auto &field : state_fields())
      if (std::any_of(names.begin(), names.end(), [&](const auto &name) { return is_called(field, name); }))
        ordered.push_back(field.name);
    return ordered;
  }

  bool
  StateFields::has_gradients() const
  {
    return std::any_of(chosen.begin(), chosen.end(), [](const auto *field) { return field->components == tensor; });
  }

  std::vector<Field>
  StateFields::list() const
  {
    std::vector<Field> fields;
    for (const auto *field : chosen)
      fields.push_back({field->full_name(), field->components(dim)});
    return fields;
  }

  void
  StateFields::fill(const PointState &state, double *values) const
  {
    for (const auto *field : chosen)
      {
        field->fill(state, dim, values);
        values += field->components(dim);
      }
  }
} // namespace Stroma::Output
