#include <stroma/base/formula.h>
#include <stroma/base/memory.h>
#include <stroma/base/text.h>
#include <stroma/studies/places.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace Stroma::Studies
{
  namespace
  {
    /// Throws UserError if the samples at @p n places would not fit in the memory.
    void
    check_places(const std::string &where, const double n, const MPI_Comm comm)
    {
      constexpr double per_place = 200.; // place, weight, material and the values of a few fields of both sides
      Memory::require(comm, n * per_place, where, Memory::about(n) + " places of comparison");
    }

    /// This rank's part of @p n things in a row.
    std::pair<std::size_t, std::size_t>
    share_of_rank(const std::size_t n, const MPI_Comm comm)
    {
      const std::size_t rank    = dealii::Utilities::MPI::this_mpi_process(comm),
                        n_ranks = dealii::Utilities::MPI::n_mpi_processes(comm);
      return {n * rank / n_ranks, n * (rank + 1) / n_ranks};
    }
  } // namespace

  PlaceSet
  lattice(const SceneGeometry &geometry, std::vector<unsigned int> n, const MPI_Comm comm)
  {
    const auto        &frame = geometry.frame;
    const unsigned int dim   = frame.dimension;
    if (n.empty())
      n.assign(dim, dim == 2 ? 64 : 32);
    if (n.size() != dim || std::count(n.begin(), n.end(), 0u) > 0)
      throw UserError("the grid of places needs " + std::to_string(dim) + " positive numbers of cells, one an axis");
    n.resize(3, 1);
    check_places("the grid of places", double(n[0]) * n[1] * n[2], comm);
    PlaceSet places{points_name, {}};
    double   volume = frame.thickness;
    for (unsigned int d = 0; d < dim; ++d)
      volume *= (frame.upper[d] - frame.lower[d]) / n[d];
    const auto [begin, end] = share_of_rank(std::size_t(n[0]) * n[1] * n[2], comm);
    for (std::size_t cell = begin; cell < end; ++cell)
      {
        Place                            X{};
        const std::array<std::size_t, 3> index{{cell % n[0], cell / n[0] % n[1], cell / n[0] / n[1]}};
        for (unsigned int d = 0; d < dim; ++d)
          X[d] = frame.lower[d] + (index[d] + .5) / n[d] * (frame.upper[d] - frame.lower[d]);
        if (const auto material = geometry.material_at(X))
          {
            places.samples.X.push_back(X);
            places.samples.weight.push_back(volume);
            places.samples.material.push_back(*material);
          }
      }
    return places;
  }

  PlaceSet
  line_places(const std::string &text, const unsigned int dim, const unsigned int n, const MPI_Comm comm)
  {
    check_places("--samples", n, comm);
    const auto                         ends = split(text, ':');
    std::vector<std::array<double, 3>> X;
    try
      {
        for (const auto &end : ends)
          {
            const auto parts = split(end, ',');
            if (parts.size() != dim)
              throw UserError("wrong number of coordinates");
            X.push_back({});
            for (unsigned int d = 0; d < dim; ++d)
              if (!plain_number(parts[d], X.back()[d]))
                throw UserError("not a number");
          }
        if (X.size() != 2 || X[0] == X[1] || n < 2)
          throw UserError("no line");
      }
    catch (const std::exception &)
      {
        const std::string place = dim == 2 ? "x, y" : "x, y, z";
        throw UserError("--line", "'" + text + "' was given with " + counted(n, "place") + "; it must be '" + place +
                                    " : " + place + "', two different places in m, with at least 2 samples");
      }
    PlaceSet   places{text, {}};
    const auto share = share_of_rank(n, comm);
    for (std::size_t i = share.first; i < share.second; ++i)
      {
        const double s = static_cast<double>(i) / (n - 1);
        Place        place{};
        for (unsigned int d = 0; d < dim; ++d)
          place[d] = (1 - s) * X[0][d] + s * X[1][d];
        places.samples.X.push_back(place);
      }
    return places;
  }

  PlaceSet
  part_of(const PlaceSet &all, const std::size_t begin, const std::size_t end)
  {
    const auto cut = [&](const auto &whole, const std::size_t width = 1) {
      return whole.empty() ? whole :
                             std::decay_t<decltype(whole)>(whole.begin() + begin * width, whole.begin() + end * width);
    };
    const auto &samples = all.samples;
    return {all.name,
            {cut(samples.X),
             cut(samples.weight),
             cut(samples.material),
             cut(samples.values, samples.X.empty() ? 1 : samples.values.size() / samples.X.size()),
             {}},
            begin};
  }

  void
  append(const PlaceSet &part, PlaceSet &all)
  {
    const auto add = [](const auto &from, auto &to) { to.insert(to.end(), from.begin(), from.end()); };
    add(part.samples.X, all.samples.X);
    add(part.samples.weight, all.samples.weight);
    add(part.samples.material, all.samples.material);
    add(part.samples.values, all.samples.values);
  }
} // namespace Stroma::Studies
