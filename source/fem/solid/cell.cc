#include <stroma/fem/solid/cell.h>
#include <stroma/materials/viscosity.h>
#include <stroma/scene/rheology.h>

#include <deal.II/base/quadrature_lib.h>

#include <cmath>

namespace Stroma::Fem
{
  namespace
  {
    template <int dim>
    dealii::Tensor<2, 3>
    in_space(const dealii::Tensor<2, dim> &plane)
    {
      dealii::Tensor<2, 3> result;
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          result[i][j] = plane[i][j];
      return result;
    }

    template <int dim>
    std::vector<std::unique_ptr<Materials::Material>>
    small_laws_of(const Scene<dim> &scene)
    {
      std::vector<std::unique_ptr<Materials::Material>> laws;
      for (const auto &law : scene.materials)
        laws.push_back(law->small_strain());
      return laws;
    }

    const dealii::Tensor<2, 3> identity = dealii::unit_symmetric_tensor<3>();
  } // namespace

  template <int dim>
  SolidCell<dim>::SolidCell(const Scene<dim> &scene, const Settings<dim> &settings, const dealii::FESystem<dim> &fe,
                            const dealii::Mapping<dim> &mapping)
    : scene(scene)
    , settings(settings)
    , fe(fe)
    , fe_values(mapping, fe, dealii::QGauss<dim>(settings.n_quadrature_points()),
                dealii::update_values | dealii::update_gradients | dealii::update_JxW_values |
                  dealii::update_quadrature_points)
    , n_q(fe_values.n_quadrature_points)
    , n_dofs(fe.n_dofs_per_cell())
    , n_nodes(n_dofs / dim)
    , small(settings.kinematics == Kinematics::small)
    , projected(settings.dilatation == Dilatation::projected)
    , viscous(is_viscous(scene))
    , thins(scene.plane == Materials::PlaneModel::stress && !small)
    , small_laws(small ? small_laws_of(scene) : std::vector<std::unique_ptr<Materials::Material>>())
    , block(pointers_to(small ? small_laws : scene.materials))
  {
    for (unsigned int a = 0; a < n_dofs; ++a)
      place_of.push_back(fe.system_to_component_index(a));
    W.resize(n_q);
    materials.resize(n_q);
    g.assign(n_q, std::vector<Gradient>(n_nodes));
    for (auto *tensors : {&L, &S, &rate})
      tensors->resize(n_q);
    for (auto *numbers : {&J, &J_bar, &pi, &theta, &mean_rate})
      numbers->resize(n_q, 1.);
    block.resize(n_q);
  }

  template <int dim>
  void
  SolidCell<dim>::reinit(const typename dealii::DoFHandler<dim>::active_cell_iterator &cell, const double *history)
  {
    fe_values.reinit(cell);
    block.runs.clear();
    for (unsigned int q = 0; q < n_q; ++q)
      {
        W[q]         = volume(q);
        materials[q] = settings.material_place == MaterialPlace::cell ?
                         cell->material_id() :
                         scene.material_at(place(q)).value_or(cell->material_id());
        if (block.runs.empty() || block.runs.back().material != materials[q])
          block.runs.push_back({materials[q], q, q});
        block.runs.back().end = q + 1;
      }
    if (history != nullptr)
      block.gather_history([&](const unsigned int q) { return history + q * n_history(); });
    if (projected)
      make_projection();
  }

  /// Polynomials of one degree less than the displacement's, made orthonormal over the undeformed cell.
  template <int dim>
  void
  SolidCell<dim>::make_projection()
  {
    modes.clear();
    const auto               &unit   = fe_values.get_quadrature().get_points();
    const unsigned int        degree = settings.degree - 1;
    std::vector<unsigned int> power(dim, 0);
    for (unsigned int n = 0, all = std::pow(degree + 1, dim); n < all; ++n)
      {
        unsigned int rest = n, total = 0;
        for (unsigned int d = 0; d < dim; ++d, rest /= degree + 1)
          total += power[d] = rest % (degree + 1);
        if (total > degree)
          continue;
        std::vector<double> mode(n_q, 1.);
        for (unsigned int q = 0; q < n_q; ++q)
          for (unsigned int d = 0; d < dim; ++d)
            mode[q] *= std::pow(unit[q][d] - .5, power[d]);
        const auto product = [&](const std::vector<double> &a, const std::vector<double> &b) {
          double sum = 0;
          for (unsigned int q = 0; q < n_q; ++q)
            sum += W[q] * a[q] * b[q];
          return sum;
        };
        for (const auto &earlier : modes)
          {
            const double part = product(mode, earlier);
            for (unsigned int q = 0; q < n_q; ++q)
              mode[q] -= part * earlier[q];
          }
        const double norm = std::sqrt(product(mode, mode));
        for (double &value : mode)
          value /= norm;
        modes.push_back(mode);
      }
  }

  template <int dim>
  void
  SolidCell<dim>::project(std::vector<double> &values) const
  {
    std::vector<double> result(n_q, 0.);
    for (const auto &mode : modes)
      {
        double part = 0;
        for (unsigned int q = 0; q < n_q; ++q)
          part += W[q] * mode[q] * values[q];
        for (unsigned int q = 0; q < n_q; ++q)
          result[q] += part * mode[q];
      }
    values = result;
  }

  template <int dim>
  void
  SolidCell<dim>::find_kinematics(const Motion &motion)
  {
    for (unsigned int q = 0; q < n_q; ++q)
      {
        dealii::Tensor<2, dim> H, rate_of_H;
        for (unsigned int a = 0; a < n_dofs; ++a)
          {
            const auto [c, i] = place_of[a];
            const Gradient &G = fe_values.shape_grad(a, q);
            g[q][i]           = G;
            H[c] += motion.u[a] * G;
            if (viscous)
              rate_of_H[c] += motion.v[a] * G;
          }
        block.F[q] = identity + in_space<dim>(H);
        J[q]       = small ? 1. : determinant(block.F[q]);
        if (!small)
          {
            const auto inverse = invert(dealii::unit_symmetric_tensor<dim>() + H);
            rate_of_H          = rate_of_H * inverse;
            for (auto &gradient : g[q])
              gradient = gradient * inverse; // F^{-T} G
          }
        L[q] = in_space<dim>(rate_of_H);
      }
    if (projected && small)
      {
        std::vector<double> strain(n_q);
        for (unsigned int q = 0; q < n_q; ++q)
          strain[q] = trace(block.F[q]) - 3.;
        auto mean = strain;
        project(mean);
        for (unsigned int q = 0; q < n_q; ++q)
          block.F[q] += (mean[q] - strain[q]) / 3. * identity;
        J_bar = J;
      }
    else if (projected)
      {
        J_bar = J;
        project(J_bar);
        for (unsigned int q = 0; q < n_q; ++q)
          block.F[q] *= std::cbrt(J_bar[q] / J[q]);
      }
  }

  /// @param wanted besides the stress, of Materials::Wanted
  template <int dim>
  StepStatus
  SolidCell<dim>::evaluate(const unsigned int wanted, const Motion &motion)
  {
    find_kinematics(motion);
    for (unsigned int q = 0; q < n_q; ++q)
      if (!(J[q] > 0.) || (projected && !(J_bar[q] > 0.)))
        return StepStatus::inverted_point;
    block.dt                = motion.dt;
    const StepStatus status = block.evaluate(thins ? wanted | Materials::stretch : wanted);
    if (status == StepStatus::ok)
      find_stress();
    return status;
  }

  template <int dim>
  void
  SolidCell<dim>::find_stress()
  {
    if (projected)
      {
        for (unsigned int q = 0; q < n_q; ++q)
          pi[q] = trace(block.tau[q]) / (3. * J_bar[q]);
        project(pi);
      }
    for (unsigned int q = 0; q < n_q; ++q)
      {
        S[q] = projected ? dealii::Tensor<2, 3>(deviator(block.tau[q])) + pi[q] * J[q] * identity :
                           dealii::Tensor<2, 3>(block.tau[q]);
        if (viscous)
          S[q] += J[q] * Materials::viscous_stress(scene.media[materials[q]], L[q]);
      }
  }

  template <int dim>
  StepStatus
  SolidCell<dim>::force(const Motion &motion, dealii::Vector<double> &f)
  {
    f                       = 0.;
    const StepStatus status = evaluate(Materials::energy, motion);
    if (status != StepStatus::ok)
      return status;
    for (unsigned int q = 0; q < n_q; ++q)
      for (unsigned int a = 0; a < n_dofs; ++a)
        {
          const auto [c, i] = place_of[a];
          double sum        = 0.;
          for (unsigned int j = 0; j < dim; ++j)
            sum += S[q][c][j] * g[q][i][j];
          f(a) += W[q] * sum;
        }
    if (!motion.a.empty())
      for (unsigned int q = 0; q < n_q; ++q)
        {
          const double           rho = scene.media[materials[q]].density;
          dealii::Tensor<1, dim> acceleration;
          for (unsigned int b = 0; b < n_dofs; ++b)
            acceleration[place_of[b].first] += motion.a[b] * fe_values.shape_value(b, q);
          for (unsigned int a = 0; a < n_dofs; ++a)
            f(a) += W[q] * rho * acceleration[place_of[a].first] * fe_values.shape_value(a, q);
        }
    return StepStatus::ok;
  }

  template <int dim>
  double
  SolidCell<dim>::summed_force_square(const Motion &motion)
  {
    const auto largest = [](const std::vector<double> &values) {
      double result = 0;
      for (const double value : values)
        result = std::max(result, std::abs(value));
      return result;
    };
    const double u = largest(motion.u);
    const double v = largest(motion.v) + 2. * std::abs(motion.v_factor) * u; // v = factor u + known, which may cancel
    const double a = largest(motion.a) + 2. * std::abs(motion.a_factor) * u;
    summed.assign(n_nodes, 0.);
    for (unsigned int q = 0; q < n_q; ++q)
      {
        double gradient = 0;
        for (const auto &g_i : g[q])
          gradient += g_i.norm();
        const auto  &medium = scene.media[materials[q]];
        const double stress = block.law(materials[q]).p_wave_modulus() * (1. + gradient * u) + S[q].norm() +
                              (viscous ? 3. * medium.viscosity * gradient * v : 0.);
        const double inertia = motion.a.empty() ? 0. : medium.density * a / n_nodes;
        for (unsigned int i = 0; i < n_nodes; ++i)
          summed[i] += W[q] * (stress * g[q][i].norm() + inertia);
      }
    double square = 0;
    for (const double force : summed)
      square += dim * force * force;
    return square;
  }

  /// rate = dS - S l^T for l = grad of the shape function of one unknown, so that d(S g) = rate g.
  template <int dim>
  void
  SolidCell<dim>::stress_rate(const Motion &motion, const unsigned int component, const unsigned int node)
  {
    if (projected)
      {
        for (unsigned int q = 0; q < n_q; ++q)
          theta[q] = J[q] * g[q][node][component];
        project(theta); // change of Jbar
      }
    for (unsigned int q = 0; q < n_q; ++q)
      {
        dealii::Tensor<2, 3> l;
        for (unsigned int d = 0; d < dim; ++d)
          l[component][d] = g[q][node][d];
        const double         volume_rate = l[component][component];
        dealii::Tensor<2, 3> l_bar       = l;
        if (projected)
          l_bar += (theta[q] / J_bar[q] - volume_rate) / 3. * identity;
        dealii::Tensor<2, 3> change = dealii::Tensor<2, 3>(block.Jc[q] * symmetrize(l_bar));
        if (!small)
          {
            const auto turned = l_bar * dealii::Tensor<2, 3>(block.tau[q]);
            change += turned + transpose(turned);
          }
        if (projected)
          {
            const double mean = trace(change) / 3.;
            mean_rate[q]      = (mean - trace(block.tau[q]) / 3. * theta[q] / J_bar[q]) / J_bar[q];
            change -= mean * identity;
            if (!small)
              change += pi[q] * J[q] * volume_rate * identity;
          }
        if (viscous)
          {
            const auto &medium = scene.media[materials[q]];
            if (small)
              change += motion.v_factor * Materials::viscous_stress(medium, l);
            else
              change += J[q] * (volume_rate * Materials::viscous_stress(medium, L[q]) +
                                Materials::viscous_stress(medium, motion.v_factor * l - L[q] * l));
          }
        rate[q] = small ? change : change - S[q] * transpose(l);
      }
    if (projected)
      {
        if (small)
          for (unsigned int q = 0; q < n_q; ++q)
            mean_rate[q] += trace(block.tau[q]) / 3. * theta[q]; // J_bar does not change
        project(mean_rate);
        for (unsigned int q = 0; q < n_q; ++q)
          rate[q] += mean_rate[q] * J[q] * identity;
      }
  }

  template <int dim>
  StepStatus
  SolidCell<dim>::stiffness(const Motion &motion, dealii::FullMatrix<double> &K)
  {
    K                       = 0.;
    const StepStatus status = evaluate(Materials::tangent, motion);
    if (status != StepStatus::ok)
      return status;
    for (unsigned int b = 0; b < n_dofs; ++b)
      {
        const auto [e, k] = place_of[b];
        stress_rate(motion, e, k);
        for (unsigned int q = 0; q < n_q; ++q)
          for (unsigned int a = 0; a < n_dofs; ++a)
            {
              const auto [c, i] = place_of[a];
              double sum        = 0.;
              for (unsigned int j = 0; j < dim; ++j)
                sum += rate[q][c][j] * g[q][i][j];
              K(a, b) += W[q] * sum;
            }
      }
    if (motion.a_factor != 0.)
      {
        dealii::FullMatrix<double> M(n_dofs);
        mass(M);
        K.add(motion.a_factor, M);
      }
    return StepStatus::ok;
  }

  template <int dim>
  void
  SolidCell<dim>::mass(dealii::FullMatrix<double> &M) const
  {
    M = 0.;
    for (unsigned int q = 0; q < n_q; ++q)
      for (unsigned int a = 0; a < n_dofs; ++a)
        for (unsigned int b = 0; b < n_dofs; ++b)
          if (place_of[a].first == place_of[b].first)
            M(a, b) += W[q] * scene.media[materials[q]].density * fe_values.shape_value(a, q) *
                       fe_values.shape_value(b, q);
  }

  template <int dim>
  dealii::SymmetricTensor<2, 3>
  SolidCell<dim>::cauchy_stress(const unsigned int q) const
  {
    return symmetrize(S[q]) / (J[q] * (thins ? block.F33[q] : 1.));
  }

  template <int dim>
  double
  SolidCell<dim>::strain_energy() const
  {
    double sum = 0;
    for (unsigned int q = 0; q < n_q; ++q)
      sum += W[q] * block.psi[q];
    return sum;
  }

  template <int dim>
  void
  SolidCell<dim>::new_history(const Motion &motion, double *target)
  {
    evaluate(Materials::next_step, motion);
    block.store_history([&](const unsigned int q) { return target + q * n_history(); });
  }

  template class SolidCell<2>;
  template class SolidCell<3>;
} // namespace Stroma::Fem
