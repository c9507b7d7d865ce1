// The committed state of SolidMethod, to look at.

#include <stroma/fem/remote_cells.h>
#include <stroma/fem/solid/method.h>
#include <stroma/solid/stress_measures.h>

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/matrix_free/fe_point_evaluation.h>

namespace Stroma::Fem
{
  namespace
  {
    /// Weights of a tensor product of Gauss points in the polynomial through them, at a unit place.
    template <int dim>
    std::vector<double>
    interpolation(const dealii::Quadrature<1> &gauss, const dealii::Point<dim> &unit)
    {
      const unsigned int               n = gauss.size();
      std::vector<std::vector<double>> line(dim, std::vector<double>(n, 1.));
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int i = 0; i < n; ++i)
          for (unsigned int j = 0; j < n; ++j)
            if (j != i)
              line[d][i] *= (unit[d] - gauss.point(j)[0]) / (gauss.point(i)[0] - gauss.point(j)[0]);
      std::vector<double> weights(std::pow(n, dim));
      for (unsigned int q = 0; q < weights.size(); ++q)
        {
          weights[q] = 1.;
          for (unsigned int d = 0, rest = q; d < dim; ++d, rest /= n)
            weights[q] *= line[d][rest % n];
        }
      return weights;
    }

    void
    set_stress(Output::PointState &state, const dealii::SymmetricTensor<2, 3> &stress)
    {
      state.cauchy   = stress;
      state.pressure = Solid::pressure(stress);
    }
  } // namespace

  template <int dim>
  class SolidMethod<dim>::View : public Output::StateView
  {
  public:
    explicit View(const SolidMethod &method)
      : method(method)
    {}

    std::size_t
    n_points() const override
    {
      return std::size_t(method.mesh->triangulation.n_locally_owned_active_cells()) *
             method.system->cells.cell().n_points();
    }

    void for_each_point(const Visit &visit) const override;
    void sample(const Output::StateFields &fields, Output::Samples &samples) const override;

  private:
    const SolidMethod &method;
  };

  template <int dim>
  void
  SolidMethod<dim>::View::for_each_point(const Visit &visit) const
  {
    const auto &fe = method.unknowns->fe;
    method.system->for_each_cell(method.motion.u, method.motion.v,
                                 [&](const auto &cell, const SolidCell<dim> &integrals, const auto &m) {
                                   const auto &shapes = integrals.values();
                                   for (unsigned int q = 0; q < integrals.n_points(); ++q)
                                     {
                                       Output::PointState state;
                                       for (unsigned int a = 0; a < m.u.size(); ++a)
                                         {
                                           const unsigned int c = fe.system_to_component_index(a).first;
                                           state.u[c] += m.u[a] * shapes.shape_value(a, q);
                                           state.u_gradient[c] += m.u[a] *
                                                                  Output::in_space<dim>(shapes.shape_grad(a, q));
                                           if (!m.v.empty())
                                             state.v[c] += m.v[a] * shapes.shape_value(a, q);
                                         }
                                       set_stress(state, integrals.cauchy_stress(q));
                                       state.X = state.x = Output::place_of<dim>(integrals.place(q));
                                       for (unsigned int d = 0; d < dim; ++d)
                                         state.x[d] += state.u[d];
                                       state.stretch_z = integrals.stretch_z(q);
                                       state.V0        = integrals.volume(q);
                                       state.J         = determinant(integrals.deformation(q)) * state.stretch_z;
                                       state.material  = integrals.material(q);
                                       state.cell      = cell->active_cell_index();
                                       visit(state);
                                     }
                                 });
  }

  /// Displacement and velocity are those of the elements; stresses are continued from the quadrature points.
  template <int dim>
  void
  SolidMethod<dim>::View::sample(const Output::StateFields &fields, Output::Samples &samples) const
  {
    using namespace dealii::EvaluationFlags;
    const RemoteCells<dim>              cells(*method.mesh, samples.X);
    const dealii::QGauss<1>             gauss(method.settings.n_quadrature_points());
    const unsigned int                  width = fields.width();
    std::vector<double>                 answers(cells.n_asked() * width);
    dealii::FEPointEvaluation<dim, dim> evaluation(method.mesh->mapping(), method.unknowns->fe,
                                                   dealii::update_values | dealii::update_gradients);
    method.system->for_each_cell(method.motion.u, method.motion.v,
                                 [&](const auto &cell, const SolidCell<dim> &integrals, const auto &m) {
                                   const auto *asked = cells.in(cell);
                                   if (!asked)
                                     return;
                                   std::vector<Output::PointState> states(asked->unit.size());
                                   evaluation.reinit(cell, asked->unit);
                                   evaluation.evaluate(dealii::make_array_view(m.u), values | gradients);
                                   for (unsigned int i = 0; i < states.size(); ++i)
                                     {
                                       states[i].u          = Output::in_space<dim>(evaluation.get_value(i));
                                       states[i].u_gradient = Output::in_space<dim>(evaluation.get_gradient(i));
                                       const auto weights   = interpolation<dim>(gauss, asked->unit[i]);
                                       dealii::SymmetricTensor<2, 3> stress;
                                       for (unsigned int q = 0; q < weights.size(); ++q)
                                         stress += weights[q] * integrals.cauchy_stress(q);
                                       set_stress(states[i], stress);
                                     }
                                   if (!m.v.empty())
                                     {
                                       evaluation.evaluate(dealii::make_array_view(m.v), values);
                                       for (unsigned int i = 0; i < states.size(); ++i)
                                         states[i].v = Output::in_space<dim>(evaluation.get_value(i));
                                     }
                                   for (unsigned int i = 0; i < states.size(); ++i)
                                     fields.fill(states[i], answers.data() + (asked->first + i) * width);
                                 });
    cells.answer(answers, width, samples);
  }

  template <int dim>
  std::unique_ptr<Output::StateView>
  SolidMethod<dim>::state(bool)
  {
    return std::make_unique<View>(*this);
  }

  template class SolidMethod<2>;
  template class SolidMethod<3>;
} // namespace Stroma::Fem
