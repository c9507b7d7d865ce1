#include <stroma/output/state_fields.h>
#include <stroma/solid/stress_measures.h>

#include <deal.II/base/exceptions.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace Stroma::Output
{
  namespace
  {
    using S = PointState;

    using Names = std::vector<std::string>;

    Names
    scalar(unsigned int)
    {
      return {""};
    }

    Names
    vector(const unsigned int dim)
    {
      return dim == 2 ? Names{"x", "y"} : Names{"x", "y", "z"};
    }

    Names
    tensor(const unsigned int dim)
    {
      return dim == 2 ? Names{"xx", "xy", "yx", "yy"} : Names{"xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"};
    }

    /// Row by row, in plane scenes too.
    Names
    tensor_in_space(unsigned int)
    {
      return tensor(3);
    }

    Names
    symmetric(unsigned int)
    {
      return {"xx", "yy", "zz", "xy", "xz", "yz"};
    }

    /// The largest first.
    Names
    principal(unsigned int)
    {
      return {"1", "2", "3"};
    }

    void
    copy(const dealii::Tensor<1, 3> &a, const unsigned int dim, double *v)
    {
      for (unsigned int i = 0; i < dim; ++i)
        v[i] = a[i];
    }

    void
    copy(const std::array<double, 3> &a, double *v)
    {
      std::copy(a.begin(), a.end(), v);
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

    /// F = 1 + grad u, in space.
    dealii::Tensor<2, 3>
    deformation_gradient(const S &s)
    {
      dealii::Tensor<2, 3> F = s.u_gradient + dealii::Tensor<2, 3>(dealii::unit_symmetric_tensor<3>());
      F[2][2] += s.stretch_z - 1.;
      return F;
    }

    /// E = (F^T F - 1) / 2.
    dealii::SymmetricTensor<2, 3>
    green_lagrange(const S &s)
    {
      const auto F = deformation_gradient(s);
      return .5 * (symmetrize(transpose(F) * F) - dealii::unit_symmetric_tensor<3>());
    }

    /// e = (1 - F^-T F^-1) / 2.
    dealii::SymmetricTensor<2, 3>
    almansi(const S &s)
    {
      const auto inverse = invert(deformation_gradient(s));
      return .5 * (dealii::unit_symmetric_tensor<3>() - symmetrize(transpose(inverse) * inverse));
    }

    /// Roots of the eigenvalues of F^T F.
    std::array<double, 3>
    principal_stretches(const S &s)
    {
      auto stretches = eigenvalues(2. * green_lagrange(s) + dealii::unit_symmetric_tensor<3>());
      for (double &stretch : stretches)
        stretch = std::sqrt(stretch);
      return stretches;
    }

    /// P = det(F) sigma F^-T: force now over area at rest.
    dealii::Tensor<2, 3>
    first_piola(const S &s)
    {
      const auto F = deformation_gradient(s);
      return determinant(F) * dealii::Tensor<2, 3>(s.cauchy) * transpose(invert(F));
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
    using N                                           = unsigned int;
    constexpr bool                       of_gradients = true;
    static const std::vector<StateField> table        = {
             {"displacement", "m", vector, [](const S &s, N dim, double *v) { copy(s.u, dim, v); }},
             {"displacement_gradient", "", tensor, [](const S &s, N dim, double *v) { copy(s.u_gradient, dim, v); },
              of_gradients},
             {"velocity", "m_per_s", vector, [](const S &s, N dim, double *v) { copy(s.v, dim, v); }},
             {"velocity_gradient", "per_s", tensor, [](const S &s, N dim, double *v) { copy(s.v_gradient, dim, v); },
              of_gradients},
             {"von_mises", "Pa", scalar, [](const S &s, N, double *v) { *v = Solid::von_mises(s.cauchy); }},
             {"pressure", "Pa", scalar, [](const S &s, N, double *v) { *v = s.pressure; }},
             {"cauchy_stress", "Pa", symmetric, [](const S &s, N, double *v) { copy(s.cauchy, v); }},
             {"principal_stress", "Pa", principal, [](const S &s, N, double *v) { copy(eigenvalues(s.cauchy), v); }},
             {"first_piola_stress", "Pa", tensor_in_space, [](const S &s, N, double *v) { copy(first_piola(s), 3, v); },
              of_gradients},
             {"green_lagrange_strain", "", symmetric, [](const S &s, N, double *v) { copy(green_lagrange(s), v); },
              of_gradients},
             {"almansi_strain", "", symmetric, [](const S &s, N, double *v) { copy(almansi(s), v); }, of_gradients},
             {"principal_stretch", "", principal, [](const S &s, N, double *v) { copy(principal_stretches(s), v); },
              of_gradients},
             {"J", "", scalar, [](const S &s, N, double *v) { *v = s.J; }},
             {"material", "", scalar, [](const S &s, N, double *v) { *v = s.material; }},
             {"volume", "m3", scalar, [](const S &s, N, double *v) { *v = s.V0; }},
             {"kernel_sum", "", scalar, [](const S &s, N, double *v) { *v = s.kernel_sum; }},
             {"density", "kg_per_m3", scalar, [](const S &s, N, double *v) { *v = s.density; }},
             {"degradation_factor", "", scalar, [](const S &s, N, double *v) { *v = s.intact; }}};
    return table;
  }

  const std::vector<std::string> &
  deformation_fields()
  {
    static const std::vector<std::string> names = {"principal_stress", "first_piola_stress", "green_lagrange_strain",
                                                   "almansi_strain", "principal_stretch"};
    return names;
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
        sizes.push_back(field->components(dim).size());
        n_values += sizes.back();
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
    return std::any_of(chosen.begin(), chosen.end(), [](const auto *field) { return field->needs_gradients; });
  }

  std::vector<Field>
  StateFields::list(const FileUnits &units) const
  {
    std::vector<Field> fields;
    for (const auto *field : chosen)
      fields.push_back(
        {units.name(field->name, field->unit), static_cast<unsigned int>(field->components(dim).size())});
    return fields;
  }

  std::string
  StateFields::Number::stem(const std::string &statistic) const
  {
    std::string text = field;
    for (const auto &part : {component, statistic})
      text += part.empty() ? "" : "_" + part;
    return text;
  }

  std::string
  StateFields::Number::name(const std::string &statistic) const
  {
    return FileUnits().name(stem(statistic), unit);
  }

  std::vector<StateFields::Number>
  StateFields::numbers() const
  {
    std::vector<Number> list;
    for (const auto *field : chosen)
      for (const auto &component : field->components(dim))
        list.push_back({field->name, component, field->unit});
    return list;
  }

  std::vector<double>
  StateFields::factors(const FileUnits &units) const
  {
    std::vector<double> list;
    for (const auto &number : numbers())
      list.push_back(units.of(number.unit).factor);
    return list;
  }

  void
  StateFields::fill(const PointState &state, double *values) const
  {
    for (std::size_t f = 0; f < chosen.size(); ++f)
      {
        chosen[f]->fill(state, dim, values);
        values += sizes[f];
      }
  }
} // namespace Stroma::Output
