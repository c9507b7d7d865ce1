#include <stroma/sph/solve_history.h>

#include <deal.II/base/mpi.h>
#include <deal.II/lac/householder.h>
#include <deal.II/lac/vector.h>

#include <cstring>

namespace Stroma::Sph
{
  namespace
  {
    /// Solves that are kept.
    constexpr unsigned int n_kept = 5;

    template <int dim>
    double
    product(const std::vector<dealii::Tensor<1, dim>> &a, const std::vector<dealii::Tensor<1, dim>> &b)
    {
      double sum = 0.;
      for (unsigned int i = 0; i < a.size(); ++i)
        sum += a[i] * b[i];
      return sum;
    }

    std::string
    name_of_solve(const unsigned int k, const char *what)
    {
      return "solves/" + std::to_string(k) + "/" + what;
    }

    template <int dim>
    dealii::ArrayView<const double>
    numbers_in(const std::vector<dealii::Tensor<1, dim>> &field)
    {
      return {reinterpret_cast<const double *>(field.data()), dim * field.size()};
    }
  } // namespace

  template <int dim>
  SolveHistory<dim>::SolveHistory(const MPI_Comm comm)
    : comm(comm)
  {}

  template <int dim>
  void
  SolveHistory<dim>::add(const Velocities &v, const Velocities &f, const unsigned int order)
  {
    if (order != order_of_solves)
      solves.clear();
    order_of_solves = order;
    if (solves.size() == n_kept)
      solves.pop_back();
    solves.push_front({{v.begin(), v.begin() + f.size()}, f});
  }

  template <int dim>
  bool
  SolveHistory<dim>::guess(Velocities &v, const Velocities &f, const double error, const unsigned int order) const
  {
    const unsigned int n = order == order_of_solves ? solves.size() : 0;
    if (n == 0)
      return false;
    std::vector<double> products; // f_k f_l for l <= k, f_k f; f f
    for (unsigned int k = 0; k < n; ++k)
      {
        for (unsigned int l = 0; l <= k; ++l)
          products.push_back(product(solves[k].f, solves[l].f));
        products.push_back(product(solves[k].f, f));
      }
    products.push_back(product(f, f));
    dealii::Utilities::MPI::sum(products, comm, products);

    dealii::FullMatrix<double> matrix(n, n);
    dealii::Vector<double>     right(n), c(n);
    auto                       next = products.begin();
    for (unsigned int k = 0; k < n; ++k)
      {
        for (unsigned int l = 0; l <= k; ++l)
          matrix(k, l) = matrix(l, k) = *next++;
        right(k) = *next++;
      }
    if (!(*next > 0.) || !std::isfinite(*next))
      return false;
    for (unsigned int k = 0; k < n; ++k)
      matrix(k, k) += error * error * *next;
    // Forces are so alike that an inverse of the matrix would tell nothing.
    dealii::Householder<double>(matrix).least_squares(c, right);
    for (unsigned int i = 0; i < f.size(); ++i)
      {
        v[i] = 0.;
        for (unsigned int k = 0; k < n; ++k)
          v[i] += c(k) * solves[k].v[i];
      }
    return true;
  }

  template <int dim>
  void
  SolveHistory<dim>::save(Output::ArchiveWriter &archive, const unsigned int order) const
  {
    const unsigned int n = order == order_of_solves ? solves.size() : 0;
    archive.attribute("solves_before", std::uint64_t(n));
    for (unsigned int k = 0; k < n; ++k)
      {
        archive.write(name_of_solve(k, "velocity"), numbers_in(solves[k].v));
        archive.write(name_of_solve(k, "force"), numbers_in(solves[k].f));
      }
  }

  template <int dim>
  void
  SolveHistory<dim>::restore(const Output::ArchiveReader &archive, const unsigned int order)
  {
    const auto read = [&](const unsigned int k, const char *what) {
      const auto numbers = archive.read_double(name_of_solve(k, what));
      Velocities field(numbers.size() / dim);
      if (!numbers.empty())
        std::memcpy(static_cast<void *>(field.data()), numbers.data(), numbers.size() * sizeof(double));
      return field;
    };
    const auto n = archive.attribute_uint64("solves_before");
    for (unsigned int k = 0; k < n; ++k)
      solves.push_back({read(k, "velocity"), read(k, "force")});
    order_of_solves = order;
  }

  template class SolveHistory<2>;
  template class SolveHistory<3>;
} // namespace Stroma::Sph
