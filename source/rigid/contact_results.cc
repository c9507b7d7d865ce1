#include <stroma/output/collective.h>
#include <stroma/rigid/contact_results.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace Stroma::Rigid
{
  namespace
  {
    /// [m]
    double
    half_width(std::vector<std::array<double, 2>> profile)
    {
      const std::size_t n = profile.size();
      if (n < 2)
        return 0.;
      std::sort(profile.begin(), profile.end());
      const auto edge = [](const std::array<double, 2> &inner, const std::array<double, 2> &outer) {
        const double fall   = inner[1] * inner[1] - outer[1] * outer[1];
        const double beyond = fall > 0. ? std::min(1., outer[1] * outer[1] / fall) : 1.;
        return outer[0] + beyond * (outer[0] - inner[0]);
      };
      return .5 * (edge(profile[n - 2], profile[n - 1]) - edge(profile[1], profile[0]));
    }
  } // namespace

  template <int dim>
  std::vector<std::pair<std::string, double>>
  ContactResults<dim>::named(const std::string &body, const MPI_Comm comm) const
  {
    std::vector<std::pair<std::string, double>> named;
    const auto                                  total = dealii::Utilities::MPI::sum(force, comm);
    for (unsigned int d = 0; d < dim; ++d)
      named.emplace_back("contact_force_" + body + "_" + "xyz"[d] + "_N", total[d]);
    const auto all  = Output::gather_all(profile, comm);
    double     peak = 0.;
    for (const auto &entry : all)
      peak = std::max(peak, entry[1]);
    named.emplace_back("contact_pressure_max_" + body + "_Pa", peak);
    named.emplace_back("contact_area_" + body + "_m2", dealii::Utilities::MPI::sum(area, comm));
    if (dim == 2)
      named.emplace_back("contact_half_width_" + body + "_m", half_width(all));
    return named;
  }

  template struct ContactResults<2>;
  template struct ContactResults<3>;
} // namespace Stroma::Rigid
