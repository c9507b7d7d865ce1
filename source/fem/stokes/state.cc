// The committed state of StokesMethod, to look at.

#include <stroma/fem/remote_cells.h>
#include <stroma/fem/stokes/method.h>

namespace Stroma::Fem
{
  template <int dim>
  class StokesMethod<dim>::View : public Output::StateView
  {
  public:
    explicit View(const StokesMethod &method)
      : method(method)
    {}

    std::size_t
    n_points() const override
    {
      return std::size_t(method.mesh->triangulation.n_locally_owned_active_cells()) * quadrature().size();
    }

    void for_each_point(const Visit &visit) const override;
    void sample(const Output::StateFields &fields, Output::Samples &samples) const override;
    bool
    pressure_level_is_free() const override
    {
      return method.free_level;
    }

  private:
    /// Finer than that of the equations, whose points errors are too small at.
    dealii::QGauss<dim>
    quadrature() const
    {
      return dealii::QGauss<dim>(method.settings.degree + 2);
    }
    Output::PointState state_of(const Point &q) const;

    const StokesMethod &method;
  };

  template <int dim>
  Output::PointState
  StokesMethod<dim>::View::state_of(const Point &q) const
  {
    Output::PointState state;
    state.X = state.x = Output::place_of<dim>(q.X);
    state.v           = Output::in_space<dim>(q.v);
    state.v_gradient  = Output::in_space<dim>(q.G);
    state.pressure    = q.p;
    state.cauchy      = symmetrize(method.system->viscosity(q.material).stress(state.v_gradient));
    for (unsigned int d = 0; d < 3; ++d)
      state.cauchy[d][d] -= q.p;
    state.V0       = q.JxW;
    state.material = q.material;
    return state;
  }

  template <int dim>
  void
  StokesMethod<dim>::View::for_each_point(const Visit &visit) const
  {
    method.system->for_each_point(method.flow, quadrature(), [&](const auto &cell, const Point &q) {
      auto state = state_of(q);
      state.cell = cell->active_cell_index();
      visit(state);
    });
  }

  template <int dim>
  void
  StokesMethod<dim>::View::sample(const Output::StateFields &fields, Output::Samples &samples) const
  {
    const RemoteCells<dim> cells(*method.mesh, samples.X);
    const unsigned int     width = fields.width();
    std::vector<double>    answers(cells.n_asked() * width);
    const StokesFlow       ghosted = method.system->with_ghosts(method.flow);
    std::vector<Point>     points;
    for (const auto &cell : method.mesh->triangulation.active_cell_iterators())
      if (const auto *asked = cells.in(cell))
        {
          StokesCell<dim> values(*method.space, dealii::Quadrature<dim>(asked->unit));
          method.system->evaluate(points, ghosted, values, cell);
          for (unsigned int i = 0; i < points.size(); ++i)
            fields.fill(state_of(points[i]), answers.data() + (asked->first + i) * width);
        }
    cells.answer(answers, width, samples);
  }

  template <int dim>
  std::unique_ptr<Output::StateView>
  StokesMethod<dim>::state(bool)
  {
    return std::make_unique<View>(*this);
  }

  template class StokesMethod<2>;
  template class StokesMethod<3>;
} // namespace Stroma::Fem
