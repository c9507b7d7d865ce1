#include <stroma/sph/velocity_history.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

namespace Stroma::Sph
{
  /// Highest degree. Each one more takes some iterations of a smooth solve; errors of the solves grow by the sum of its weights.
  static constexpr unsigned int highest_degree = 3;

  /// Most that errors may grow by: the sum of |weights| of equal steps and the highest degree, 4, 6, 4 and 1, and a little more.
  static constexpr double largest_sum = 30.;

  /// Name of what is kept of state @p k before the last one.
  static std::string
  name_of_state(const unsigned int k)
  {
    return "velocity before " + std::to_string(k);
  }

  static double
  sum_of(const std::vector<double> &weights)
  {
    double sum = 0.;
    for (const double w : weights)
      sum += std::abs(w);
    return sum;
  }

  template <int dim>
  std::vector<double>
  VelocityHistory<dim>::weights(const unsigned int n, const double ahead) const
  {
    std::vector<double> times(1), result(n + 1, 1.); // of the states, from now
    for (unsigned int k = 0; k < n; ++k)
      times.push_back(times.back() - past[k].step);
    for (unsigned int k = 0; k <= n; ++k)
      for (unsigned int l = 0; l <= n; ++l)
        if (l != k)
          result[k] *= (ahead - times[l]) / (times[k] - times[l]);
    return result;
  }

  template <int dim>
  void
  VelocityHistory<dim>::extrapolate(Velocities &v, const unsigned int n_free, const double ahead,
                                    const unsigned int order_now) const
  {
    if (order != order_now)
      return;
    auto w = weights(std::min<std::size_t>(degree, past.size()), ahead);
    while (sum_of(w) > largest_sum)
      w = weights(w.size() - 2, ahead);
    for (unsigned int i = 0; i < n_free; ++i)
      {
        v[i] *= w[0];
        for (unsigned int k = 1; k < w.size(); ++k)
          v[i] += w[k] * past[k - 1].v[i];
      }
  }

  template <int dim>
  unsigned int
  VelocityHistory<dim>::best_degree(const Velocities &v, const Velocities &next, const unsigned int n_free,
                                    const double dt, const MPI_Comm comm) const
  {
    std::vector<double> faults; // squared, by degree
    for (unsigned int n = 0; n <= past.size(); ++n)
      {
        const auto w     = weights(n, dt);
        double     fault = 0.;
        for (unsigned int i = 0; i < n_free; ++i)
          {
            auto left = next[i] - w[0] * v[i];
            for (unsigned int k = 1; k <= n; ++k)
              left -= w[k] * past[k - 1].v[i];
            fault += left.norm_square();
          }
        faults.push_back(fault);
      }
    dealii::Utilities::MPI::sum(faults, comm, faults);
    return static_cast<unsigned int>(std::min_element(faults.begin(), faults.end()) - faults.begin());
  }

  template <int dim>
  void
  VelocityHistory<dim>::add(Velocities &&v, const Velocities &next, const unsigned int n_free, const double dt,
                            const unsigned int order_now, const MPI_Comm comm)
  {
    if (order != order_now)
      past.clear();
    order = order_now;
    if (in_balance)
      {
        degree = past.empty() ? 1 : best_degree(v, next, n_free, dt, comm);
        past.insert(past.begin(), {std::move(v), dt});
        past.resize(std::min<std::size_t>(past.size(), highest_degree));
      }
    in_balance = true;
  }

  template <int dim>
  void
  VelocityHistory<dim>::save(Output::ArchiveWriter &archive, const unsigned int n_owned,
                             const unsigned int order_now) const
  {
    const std::uint64_t n = order == order_now ? past.size() : 0;
    archive.attribute("is_in_balance", std::uint64_t(in_balance));
    archive.attribute("degree_of_guess", std::uint64_t(degree));
    archive.attribute("n_velocities_before", n);
    for (unsigned int k = 0; k < n; ++k)
      {
        archive.attribute("step_before_" + std::to_string(k), past[k].step);
        archive.write(name_of_state(k),
                      dealii::ArrayView<const double>(reinterpret_cast<const double *>(past[k].v.data()),
                                                      dim * n_owned));
      }
  }

  template <int dim>
  void
  VelocityHistory<dim>::restore(const Output::ArchiveReader &archive, const unsigned int order_now)
  {
    in_balance = archive.attribute_uint64("is_in_balance") == 1;
    degree     = archive.attribute_uint64("degree_of_guess");
    order      = order_now;
    past.resize(archive.attribute_uint64("n_velocities_before"));
    for (unsigned int k = 0; k < past.size(); ++k)
      {
        past[k].step       = archive.attribute_double("step_before_" + std::to_string(k));
        const auto numbers = archive.read_double(name_of_state(k));
        past[k].v.resize(numbers.size() / dim);
        if (!numbers.empty())
          std::memcpy(static_cast<void *>(past[k].v.data()), numbers.data(), numbers.size() * sizeof(double));
      }
  }

  template class VelocityHistory<2>;
  template class VelocityHistory<3>;
} // namespace Stroma::Sph
