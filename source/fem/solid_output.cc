// Fields and results of SolidMethod.

#include <stroma/fem/solid_method.h>
#include <stroma/output/grid_writer.h>
#include <stroma/output/statistics.h>
#include <stroma/solid/stress_measures.h>

#include <algorithm>
#include <cmath>

namespace Stroma::Fem
{
  namespace
  {
    struct CellScalar
    {
      std::string name, field; ///< in the file; as asked for
      double (*value)(const dealii::SymmetricTensor<2, 3> &stress, double J, unsigned int material);
    };

    const std::vector<CellScalar> &
    cell_scalars()
    {
      using Stress = dealii::SymmetricTensor<2, 3>;
      static const std::vector<CellScalar> table = {
        {"von_mises_Pa", "von_mises", [](const Stress &s, double, unsigned int) { return Solid::von_mises(s); }},
        {"pressure_Pa", "pressure", [](const Stress &s, double, unsigned int) { return Solid::pressure(s); }},
        {"cauchy_stress_xx_Pa", "cauchy_stress", [](const Stress &s, double, unsigned int) { return s[0][0]; }},
        {"cauchy_stress_yy_Pa", "cauchy_stress", [](const Stress &s, double, unsigned int) { return s[1][1]; }},
        {"cauchy_stress_zz_Pa", "cauchy_stress", [](const Stress &s, double, unsigned int) { return s[2][2]; }},
        {"cauchy_stress_xy_Pa", "cauchy_stress", [](const Stress &s, double, unsigned int) { return s[0][1]; }},
        {"cauchy_stress_xz_Pa", "cauchy_stress", [](const Stress &s, double, unsigned int) { return s[0][2]; }},
        {"cauchy_stress_yz_Pa", "cauchy_stress", [](const Stress &s, double, unsigned int) { return s[1][2]; }},
        {"J", "J", [](const Stress &, double J, unsigned int) { return J; }},
        {"material", "material", [](const Stress &, double, unsigned int material) { return double(material); }}};
      return table;
    }
  } // namespace

  template <int dim>
  std::vector<std::string>
  SolidMethod<dim>::known_point_fields() const
  {
    return {"displacement", "velocity", "von_mises", "pressure", "cauchy_stress", "J", "material", "volume"};
  }

  template <int dim>
  std::vector<std::pair<std::string, std::string>>
  SolidMethod<dim>::write_fields(const FieldRequest &request)
  {
    const auto scope    = timers.scope("field files");
    const auto is_asked = [&](const std::string &name) {
      return std::find(request.point_fields.begin(), request.point_fields.end(), name) != request.point_fields.end();
    };
    std::vector<const CellScalar *>     chosen;
    std::vector<dealii::Vector<double>> values;
    for (const auto &scalar : cell_scalars())
      if (is_asked(scalar.field))
        {
          chosen.push_back(&scalar);
          values.emplace_back(mesh->triangulation.n_active_cells());
        }
    dealii::Vector<double> volume(mesh->triangulation.n_active_cells());
    system->for_each_cell(motion.u, motion.v, [&](const auto &cell, const SolidCell<dim> &integrals, const auto &) {
      const unsigned int c = cell->active_cell_index();
      for (unsigned int q = 0; q < integrals.n_points(); ++q)
        {
          volume[c] += integrals.volume(q);
          for (std::size_t i = 0; i < chosen.size(); ++i)
            values[i][c] += integrals.volume(q) * chosen[i]->value(integrals.cauchy_stress(q),
                                                                   determinant(integrals.deformation(q)),
                                                                   integrals.material(q));
        }
      for (auto &sum : values)
        sum[c] /= volume[c];
    });
    std::vector<Output::NodalField> nodal;
    std::vector<Output::CellField>  cells;
    for (std::size_t i = 0; i < chosen.size(); ++i)
      cells.push_back({chosen[i]->name, &values[i]});
    if (is_asked("volume") || request.grid_fields)
      cells.push_back({"material_volume_m3", &volume});
    const Vector displacement = unknowns->on_mesh(motion.u);
    const Vector velocity     = motion.v.size() > 0 ? unknowns->on_mesh(motion.v) : Vector();
    const Vector force        = unknowns->on_mesh(system->unbalanced_forces());
    if (is_asked("displacement") || request.grid_fields)
      nodal.push_back({"displacement_m", &displacement});
    if (velocity.size() > 0 && (is_asked("velocity") || request.grid_fields))
      nodal.push_back({"velocity_m_per_s", &velocity});
    if (request.grid_fields)
      nodal.push_back({"unbalanced_force_N", &force});
    if (nodal.empty() && cells.empty())
      return {};
    return {{"grid", Output::write_grid<dim>(request.folder, "grid", request.counter, unknowns->dofs, nodal, cells)}};
  }

  template <int dim>
  void
  SolidMethod<dim>::describe(Output::Summary &summary)
  {
    summary.method          = "fem";
    summary.dimension       = dim;
    summary.n_points        = 0;
    summary.n_cells         = mesh->triangulation.n_global_active_cells();
    summary.n_dofs          = unknowns->size();
    summary.bytes_per_point = std::nan("");
    summary.laws            = scene.laws_in_words(settings.kinematics == Kinematics::small);
    const auto part         = [&](const bool is_used, const std::string &name) {
      (is_used ? summary.used : summary.left_out).push_back(name);
    };
    part(K.m() > 0, "matrix: stiffness");
    part(motion.u.size() > 0, "vector: displacement");
    part(motion.v.size() > 0, "vector: velocity");
    part(motion.a.size() > 0, "vector: acceleration");
    part(last_increment.size() > 0, "vector: last increment");
    for (const auto &[name, is_there] : system->vectors())
      part(is_there, "vector: " + name);
    part(system->cells.history.size() > 0, "material history");
    part(!system->contacts.empty(), "contact");
    part(unknowns->ties.n_constraints() > 0, "tied unknowns");
    part(settings.dilatation == Dilatation::projected, "projected dilatation");
    part(!system->symmetric(), "GMRES instead of conjugate gradients");
    part(linear_settings.preconditioner == Solvers::Preconditioner::amg, "algebraic multigrid");
    part(false, "points");
    for (const auto &[name, value] : committed_scalars)
      summary.results[name] = value;
    if (n_free_parts > 0)
      summary.results["free_parts"] = n_free_parts;
    if (below_round_off.count > 0)
      summary.results["solves_below_round_off"] = below_round_off.count;
    stress_results(summary);
    error_results(summary);
  }

  template <int dim>
  void
  SolidMethod<dim>::stress_results(Output::Summary &summary)
  {
    Output::VolumeWeightedQuantiles quantiles;
    system->for_each_cell(motion.u, motion.v, [&](const auto &, const SolidCell<dim> &integrals, const auto &) {
      for (unsigned int q = 0; q < integrals.n_points(); ++q)
        quantiles.add(Solid::von_mises(integrals.cauchy_stress(q)), integrals.volume(q));
    });
    Output::von_mises_results(quantiles, scene.comm, summary.results);

    // Largest displacement of a node.
    double                                       largest = 0;
    const Vector                                 u       = unknowns->on_mesh(motion.u);
    std::vector<dealii::types::global_dof_index> dofs(unknowns->fe.n_dofs_per_cell());
    for (const auto &cell : unknowns->dofs.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          cell->get_dof_indices(dofs);
          for (unsigned int i = 0; i < dofs.size() / dim; ++i)
            {
              double square = 0;
              for (unsigned int c = 0; c < dim; ++c)
                square += std::pow(u(dofs[unknowns->fe.component_to_system_index(c, i)]), 2);
              largest = std::max(largest, square);
            }
        }
    summary.results["max_displacement_m"] = std::sqrt(dealii::Utilities::MPI::max(largest, scene.comm));
  }

  template <int dim>
  void
  SolidMethod<dim>::error_results(Output::Summary &summary)
  {
    if (!scene.exact_displacement.given())
      return;
    // Sums over the quadrature points: |u - u_exact|^2 V, |u_exact|^2 V, and the same for the gradients.
    std::array<double, 4> sums{{0, 0, 0, 0}};
    const double          step = 1e-4 * mesh->smallest_cell();
    system->for_each_cell(motion.u, motion.v, [&](const auto &, const SolidCell<dim> &integrals, const auto &m) {
      const auto &values = integrals.values();
      for (unsigned int q = 0; q < integrals.n_points(); ++q)
        {
          dealii::Tensor<1, dim> u;
          dealii::Tensor<2, dim> H;
          for (unsigned int a = 0; a < m.u.size(); ++a)
            {
              const unsigned int c = unknowns->fe.system_to_component_index(a).first;
              u[c] += m.u[a] * values.shape_value(a, q);
              H[c] += m.u[a] * values.shape_grad(a, q);
            }
          const auto  &X     = integrals.place(q);
          const double V     = integrals.volume(q);
          const auto   exact = scene.exact_displacement.value(X, time);
          sums[0] += V * (u - exact).norm_square();
          sums[1] += V * exact.norm_square();
          for (unsigned int k = 0; k < dim; ++k)
            {
              const auto d     = dealii::Point<dim>::unit_vector(k) * step;
              const auto slope = (scene.exact_displacement.value(X + d, time) -
                                  scene.exact_displacement.value(dealii::Point<dim>(X - d), time)) /
                                 (2 * step);
              for (unsigned int i = 0; i < dim; ++i)
                {
                  sums[2] += V * std::pow(H[i][k] - slope[i], 2);
                  sums[3] += V * std::pow(slope[i], 2);
                }
            }
        }
    });
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), 4, MPI_DOUBLE, MPI_SUM, scene.comm);
    summary.results["displacement_error_L2_relative"] = std::sqrt(sums[0] / sums[1]);
    summary.results["displacement_error_H1_relative"] = std::sqrt(sums[2] / sums[3]);
  }

  template class SolidMethod<2>;
  template class SolidMethod<3>;
} // namespace Stroma::Fem
