#include <stroma/output/remote_places.h>

#include <algorithm>

namespace Stroma::Output
{
  namespace
  {
    using Indices = std::map<unsigned int, std::vector<std::size_t>>; ///< of places, by rank

    Indices
    ranks_to_ask(const std::vector<Place> &X, const WhoKnows &who)
    {
      Indices indices;
      for (std::size_t i = 0; i < X.size(); ++i)
        for (const unsigned int rank : who(X[i]))
          indices[rank].push_back(i);
      return indices;
    }

    /// By rank. Collective.
    std::vector<Extent>
    all_extents(const Extent &mine, const MPI_Comm comm)
    {
      std::vector<double> numbers(mine.lower.begin(), mine.lower.end());
      numbers.insert(numbers.end(), mine.upper.begin(), mine.upper.end());
      std::vector<Extent> all;
      for (const auto &of_rank : dealii::Utilities::MPI::all_gather(comm, numbers))
        {
          all.emplace_back();
          std::copy_n(of_rank.begin(), 3, all.back().lower.begin());
          std::copy_n(of_rank.begin() + 3, 3, all.back().upper.begin());
        }
      return all;
    }

    std::vector<double>
    coordinates(const std::vector<Place> &X, const std::vector<std::size_t> &indices)
    {
      std::vector<double> numbers;
      numbers.reserve(3 * indices.size());
      for (const std::size_t i : indices)
        numbers.insert(numbers.end(), X[i].begin(), X[i].end());
      return numbers;
    }
  } // namespace

  void
  Extent::add(const Place &X)
  {
    for (unsigned int d = 0; d < 3; ++d)
      {
        lower[d] = std::min(lower[d], X[d]);
        upper[d] = std::max(upper[d], X[d]);
      }
  }

  double
  Extent::distance(const Place &X) const
  {
    double most = 0.;
    for (unsigned int d = 0; d < 3; ++d)
      most = std::max({most, lower[d] - X[d], X[d] - upper[d]});
    return most;
  }

  WhoKnows
  ranks_within(const Extent &mine, const double reach, const MPI_Comm comm)
  {
    return [extents = all_extents(mine, comm), reach](const Place &X) {
      std::vector<unsigned int> ranks;
      for (unsigned int rank = 0; rank < extents.size(); ++rank)
        if (extents[rank].distance(X) <= reach)
          ranks.push_back(rank);
      return ranks;
    };
  }

  void
  ask_ranks(Samples &samples, const unsigned int width, const WhoKnows &who,
            const std::function<Rating(const Place &, double *)> &answer, const MPI_Comm comm)
  {
    using dealii::Utilities::MPI::some_to_some;
    const auto                                  indices = ranks_to_ask(samples.X, who);
    std::map<unsigned int, std::vector<double>> questions, values;
    for (const auto &[rank, places] : indices)
      questions[rank] = coordinates(samples.X, places);
    questions = some_to_some(comm, questions);

    std::map<unsigned int, std::vector<Rating>> ratings;
    for (const auto &[rank, numbers] : questions)
      {
        const std::size_t n = numbers.size() / 3;
        ratings[rank].resize(n);
        values[rank].resize(n * width);
        for (std::size_t i = 0; i < n; ++i)
          ratings[rank][i] = answer({{numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]}},
                                    values[rank].data() + i * width);
      }
    ratings = some_to_some(comm, ratings);
    values  = some_to_some(comm, values);

    std::vector<Rating> best(samples.X.size(), knows_not);
    samples.values.assign(samples.X.size() * width, 0.);
    for (const auto &[rank, places] : indices) // in the order of ranks
      for (std::size_t k = 0; k < places.size(); ++k)
        if (ratings[rank][k] < best[places[k]])
          {
            best[places[k]] = ratings[rank][k];
            std::copy_n(values[rank].data() + k * width, width, samples.values.data() + places[k] * width);
          }
    samples.found.resize(samples.X.size());
    for (std::size_t i = 0; i < best.size(); ++i)
      samples.found[i] = best[i] != knows_not;
  }
} // namespace Stroma::Output
