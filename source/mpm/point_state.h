#pragma once

#include <stroma/mpm/system.h>
#include <stroma/output/state_fields.h>
#include <stroma/solid/stress_measures.h>

#include <algorithm>
#include <string>
#include <vector>

namespace Stroma::Mpm
{
  /// What is known of a place in the material in the committed state.
  template <int dim>
  struct PointState
  {
    dealii::Point<dim>            X; ///< undeformed place [m]
    dealii::Tensor<1, dim>        u; ///< since the start [m]
    dealii::SymmetricTensor<2, 3> cauchy; ///< [Pa]
    double                        V0, J;
    unsigned int                  material;
    dealii::Tensor<2, dim>        F;
  };

  template <int dim>
  using PointField = Output::StateField<PointState<dim>>;

  /// All fields that points can be written with.
  template <int dim>
  const std::vector<PointField<dim>> &
  point_fields()
  {
    using S = PointState<dim>;
    static const std::vector<PointField<dim>> table = {
      {"displacement", "m", dim, [](const S &s, double *v) { std::copy(s.u.begin_raw(), s.u.end_raw(), v); }},
      {"von_mises", "Pa", 1, [](const S &s, double *v) { *v = Solid::von_mises(s.cauchy); }},
      {"pressure", "Pa", 1, [](const S &s, double *v) { *v = Solid::pressure(s.cauchy); }},
      {"cauchy_stress", "Pa", 6,
       [](const S &s, double *v) {
         for (unsigned int i = 0; i < 6; ++i)
           v[i] = s.cauchy.access_raw_entry(i);
       }},
      {"J", "", 1, [](const S &s, double *v) { *v = s.J; }},
      {"material", "", 1, [](const S &s, double *v) { *v = s.material; }},
      {"volume", "m3", 1, [](const S &s, double *v) { *v = s.V0; }}};
    return table;
  }

  /// Calls @p visit(state, position, cell) for every owned point of the state with grid displacement @p u.
  template <int dim, typename Visit>
  void
  for_each_point(System<dim> &system, const Points<dim> &points, const Vector &u, const Visit &visit)
  {
    system.for_each_cell(u, [&](const auto &active, CellPoints<dim> &p, const auto &u_cell) {
      p.evaluate(Materials::stretch);
      for (const auto &run : p.runs)
        for (unsigned int q = run.begin; q < run.end; ++q)
          {
            PointState<dim> state;
            state.u = p.grid_displacement(q, u_cell);
            const dealii::Point<dim> x = p.location[q] + state.u;
            if (points.displacement.stored())
              for (unsigned int d = 0; d < dim; ++d)
                state.u[d] += p.values[q][points.displacement.first + d];
            state.X = points.initial_place(p.location[q], p.values[q]);
            for (unsigned int i = 0; i < dim; ++i)
              for (unsigned int k = 0; k < dim; ++k)
                state.F[i][k] = p.F[q][i][k];
            state.J        = determinant(state.F) * (dim == 2 ? p.F33[q] : 1.);
            state.cauchy   = p.tau[q] / state.J;
            if (p.is_viscous)
              state.cauchy += symmetrize(p.viscous_stress(q, run.material)) / p.J[q];
            state.V0       = p.V[q];
            state.material = run.material;
            visit(state, x, active);
          }
      return StepStatus::ok;
    });
  }
} // namespace Stroma::Mpm
