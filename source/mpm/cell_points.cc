#include <stroma/base/power.h>
#include <stroma/mpm/cell_points.h>

#include <algorithm>
#include <cmath>

namespace Stroma::Mpm
{
  namespace
  {
    /// The products of a place's coordinates, by bits.
    template <int dim, unsigned int n>
    inline std::array<double, n>
    products(const dealii::Point<dim> &xi)
    {
      std::array<double, n> q{};
      q[0] = 1.;
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int s = 0; s < 1u << d; ++s)
          q[s | 1u << d] = q[s] * xi[d];
      return q;
    }
  } // namespace

  template <int dim, unsigned int n>
  CellPoints<dim, n>::CellPoints(const Scene<dim> &scene, const Points<dim> &points, const BackgroundGrid<dim> &grid,
                                 const Settings<dim> &settings)
    : GatheredPoints<dim>(scene, points)
    , functions(dynamic_cast<const ShapeFunctionsOf<dim, n> &>(*grid.shape))
    , settings(settings)
    , n_materials(scene.materials.size())
    , cell_size(grid.box().cell_size)
    , whole_voxels(points.are_found_in_images() && settings.is_as_fine_as_images(scene, grid.box()))
  {}

  template <int dim, unsigned int n>
  void
  CellPoints<dim, n>::rebuild(const BackgroundGrid<dim> &grid)
  {
    standing.clear();
    interfaces.clear();
    kind_of_cell.clear();
    if (!settings.two_moments && !settings.composite)
      return;
    for (const auto &active : grid.active_cells())
      {
        const auto moments = cell_moments(this->points, active, cell_size, n_materials, whole_voxels);
        if (settings.two_moments)
          standing.add_cell(this->points, active, moments, cell_size);
        if (settings.composite)
          interfaces.add_cell(moments.of_material, this->all_laws(), cell_size);
      }
    if (settings.two_moments)
      standing.finish(this->points);
    if (settings.shares_stiffness)
      for (const auto &active : grid.active_cells())
        kind_of_cell.push_back(standing.empty() ? TwoMomentPoints<dim>::no_kind : standing.kind_of(active.number));
  }

  /// What a reset has found that the mean gradients lack, see set_weights().
  template <int dim, unsigned int n>
  inline void
  CellPoints<dim, n>::add_gradient_shift()
  {
    const auto &shifts = this->points.gradient_shift;
    if (shifts.empty())
      return;
    const double *shift = &shifts[cell->number * dim * n];
    for (unsigned int p = 0; p < this->size; ++p)
      for (unsigned int d = 0; d < dim; ++d)
        for (unsigned int a = 0; a < n; ++a)
          shape[p].gradient[d][a] += shift[d * n + a];
  }

  /// F_D of the points from the displacement of the nodes, and F.
  template <int dim, unsigned int n>
  inline void
  CellPoints<dim, n>::find_gradients()
  {
    if (g.size() < this->size)
      {
        g.resize(this->size);
        shape.resize(this->size);
      }
    functions.evaluate(cell->index, this->xi, this->size, shape);
    add_gradient_shift();
    for (unsigned int p = 0; p < this->size; ++p)
      {
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int k = 0; k < dim; ++k)
            this->F_D[p][i][k] = (i == k) + sum<n>(u[i] * shape[p].gradient[k]);
        this->find_deformation(p);
      }
  }

  template <int dim, unsigned int n>
  void
  CellPoints<dim, n>::find_series()
  {
    for (unsigned int i = 0; i < dim; ++i)
      {
        for (unsigned int a = 0; a < n; ++a)
          series[i][a] = u[i][a];
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int s = 0; s < n; ++s)
            if (s >> d & 1)
              series[i][s] -= series[i][s ^ 1u << d];
      }
  }

  /// find_gradients() of linear functions for many points of a cell.
  template <int dim, unsigned int n>
  void
  CellPoints<dim, n>::find_gradients_by_series()
  {
    find_series();
    double slope[dim][dim][n]; // [direction][component]
    for (unsigned int d = 0; d < dim; ++d)
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int s = 0; s < n; ++s)
          slope[d][i][s] = series[i][s] / cell_size[d];
    for (unsigned int p = 0; p < this->size; ++p)
      {
        const auto q = products<dim, n>(this->xi[p]);
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int i = 0; i < dim; ++i)
            {
              double sum = 0.;
              for (unsigned int s = 0; s < power(2, dim); ++s)
                if (s >> d & 1)
                  sum += slope[d][i][s] * q[s ^ 1u << d];
              this->F_D[p][i][d] = (i == d) + sum;
            }
        this->find_deformation(p);
      }
  }

  /// All points of the cell, and F.
  template <int dim, unsigned int n>
  void
  CellPoints<dim, n>::gather_all()
  {
    if (!this->points.are_found_in_images())
      this->gather_points(*cell);
    else
      this->gather_found(*cell, standing);
    by_series = this->points.are_found_in_images() && n == power(2, dim);
    if (by_series)
      find_gradients_by_series();
    else
      find_gradients();
  }

  /// The gradients g_a of a point.
  template <int dim, unsigned int n>
  inline void
  CellPoints<dim, n>::find_kinematics(const unsigned int p)
  {
    const auto                   &gradient = shape[p].gradient;
    const dealii::Tensor<2, dim> &F_D      = this->F_D[p];
    if (settings.internal_force == InternalForce::consistent)
      {
        const auto inverse = invert(F_D);
        for (unsigned int k = 0; k < dim; ++k)
          {
            g[p][k] = inverse[0][k] * gradient[0];
            for (unsigned int K = 1; K < dim; ++K)
              g[p][k] += inverse[K][k] * gradient[K];
          }
      }
    else
      g[p] = gradient;
  }

  template <int dim, unsigned int n>
  inline StepStatus
  CellPoints<dim, n>::check_gradient(const unsigned int p) const
  {
    const double J_D = determinant(this->F_D[p]);
    if (!std::isfinite(J_D))
      return StepStatus::not_finite;
    return J_D <= 0 ? StepStatus::inverted_point : StepStatus::ok;
  }

  template <int dim, unsigned int n>
  void
  CellPoints<dim, n>::find_velocity_gradient(const unsigned int p, const Nodal *v)
  {
    auto &L    = this->L[p];
    this->J[p] = determinant(this->F[p]);
    L          = 0.;
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int k = 0; k < dim; ++k)
        if (v != nullptr)
          L[i][k] = sum<n>((*v)[i] * g[p][k]);
        else if (this->points.velocity_gradient.stored())
          L[i][k] = this->values[p][this->points.velocity_gradient.first + i * dim + k];
  }

  template <int dim, unsigned int n>
  void
  CellPoints<dim, n>::gather_for_solve()
  {
    if (standing.empty())
      this->gather_points(*cell);
    else
      this->gather_standing(standing, cell->number);
  }

  /// g_a, where it is asked for, and what follows from it.
  template <int dim, unsigned int n>
  StepStatus
  CellPoints<dim, n>::finish(const Gathered which, const Nodal *v)
  {
    const bool needs_g = which == Gathered::for_solve || this->is_viscous || settings.projected;
    StepStatus status  = StepStatus::ok;
    for (unsigned int p = 0; p < this->size; ++p)
      {
        status = worse(status, check_gradient(p));
        if (needs_g)
          find_kinematics(p);
        if (this->is_viscous)
          find_velocity_gradient(p, v);
      }
    if (settings.projected && status == StepStatus::ok)
      project_dilatation();
    return status;
  }

  /// To F_D and F of all points of the cell.
  template <int dim, unsigned int n>
  void
  CellPoints<dim, n>::add_jump()
  {
    const auto by_material = jumps();
    for (const auto &run : this->runs)
      for (unsigned int p = run.begin; p < run.end; ++p)
        {
          this->F_D[p] += by_material[run.material];
          this->find_deformation(p);
        }
  }

  template <int dim, unsigned int n>
  StepStatus
  CellPoints<dim, n>::gather(const ActiveCell<dim> &active, const Gathered which, const Nodal &displacement,
                             const Nodal *v)
  {
    cell      = &active;
    u         = displacement;
    by_series = false;
    interface = interfaces.of(active.number);
    gather_for_solve();
    find_gradients();
    if (interface != nullptr)
      {
        const StepStatus status = laminate.solve(*interface, this->V, *this);
        if (status != StepStatus::ok)
          return status;
      }
    if (which == Gathered::all_points && !standing.empty())
      gather_all();
    if (interface != nullptr)
      add_jump();
    return finish(which, v);
  }

  template <int dim, unsigned int n>
  bool
  CellPoints<dim, n>::no_place_is_inverted() const
  {
    if (n != power(2, dim)) // else F_D of each place is a mean of those of the corners
      return false;
    std::vector<dealii::Point<dim>> corners;
    for (unsigned int a = 0; a < n; ++a)
      {
        corners.emplace_back();
        for (unsigned int d = 0; d < dim; ++d)
          corners[a][d] = a >> d & 1;
      }
    std::vector<Stencil<dim, n>> at(n);
    functions.evaluate(cell->index, corners, n, at);
    const auto has_one_orientation = [&](const dealii::Tensor<2, dim> &jump) {
      std::vector<dealii::Tensor<2, dim>> F(n, jump);
      dealii::Tensor<2, dim>              mean;
      for (unsigned int a = 0; a < n; ++a)
        {
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int k = 0; k < dim; ++k)
              F[a][i][k] += (i == k) + sum<n>(u[i] * at[a].gradient[k]);
          mean += F[a] / n;
        }
      // |F mean^-1 - I| < 1 holds for all means of those for which it holds, and F is regular then.
      return determinant(mean) > 0. && std::all_of(F.begin(), F.end(), [&](const auto &corner) {
               return (corner * invert(mean) - dealii::Tensor<2, dim>(dealii::unit_symmetric_tensor<dim>())).norm() <
                      1.;
             });
    };
    if (interface == nullptr)
      return has_one_orientation(dealii::Tensor<2, dim>());
    const auto of_sides = jumps();
    return std::all_of(of_sides.begin(), of_sides.end(), has_one_orientation);
  }

  template <int dim, unsigned int n>
  std::vector<dealii::Tensor<2, dim>>
  CellPoints<dim, n>::jumps() const
  {
    std::vector<dealii::Tensor<2, dim>> by_material;
    for (const double s : interface->side)
      by_material.push_back(s * outer_product(laminate.jump(), interface->normal));
    return by_material;
  }

  template <int dim, unsigned int n>
  void
  CellPoints<dim, n>::condense_jump(dealii::FullMatrix<double> &K_cell) const
  {
    if (interface != nullptr)
      laminate.template condense<n>(*interface, this->V, *this, g, K_cell);
  }

  template <int dim, unsigned int n>
  dealii::Tensor<1, dim>
  CellPoints<dim, n>::displacement(const unsigned int p) const
  {
    dealii::Tensor<1, dim> result;
    if (by_series)
      {
        const auto q = products<dim, n>(this->xi[p]);
        for (unsigned int d = 0; d < dim; ++d)
          for (unsigned int s = 0; s < n; ++s)
            result[d] += series[d][s] * q[s];
      }
    else
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = sum<n>(u[d] * shape[p].value);
    return result;
  }

  template <int dim, unsigned int n>
  dealii::Tensor<1, dim>
  CellPoints<dim, n>::displacement(const dealii::Point<dim> &xi) const
  {
    const auto             at = functions.at(cell->index, xi);
    Lanes<n>               value{};
    dealii::Tensor<1, dim> result;
    for (unsigned int a = 0; a < n; ++a)
      value[a] = at.value[a];
    for (unsigned int d = 0; d < dim; ++d)
      result[d] = sum<n>(u[d] * value);
    return result;
  }

  /// F becomes Fbar: ln J its mean over the cell.
  template <int dim, unsigned int n>
  void
  CellPoints<dim, n>::project_dilatation()
  {
    const auto &V      = this->V;
    auto       &F      = this->F;
    double      volume = 0, mean = 0;
    g_mean = {};
    for (unsigned int p = 0; p < this->size; ++p)
      {
        volume += V[p];
        mean += V[p] * std::log(determinant(F[p]));
        for (unsigned int k = 0; k < dim; ++k)
          g_mean[k] += V[p] * g[p][k];
      }
    mean /= volume;
    for (auto &gradient : g_mean)
      gradient /= volume;
    for (unsigned int p = 0; p < this->size; ++p)
      {
        const double factor = std::exp((mean - std::log(determinant(F[p]))) / dim);
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int k = 0; k < dim; ++k)
            F[p][i][k] *= factor;
      }
  }

  template class CellPoints<2, power(2, 2)>;
  template class CellPoints<2, power(3, 2)>;
  template class CellPoints<3, power(2, 3)>;
  template class CellPoints<3, power(3, 3)>;
} // namespace Stroma::Mpm
