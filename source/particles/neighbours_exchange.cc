#include <stroma/particles/neighbours_exchange.h>

#include <cstring>
#include <limits>

namespace Stroma::Particles
{
  namespace
  {
    constexpr int tag = 5207;

    template <std::size_t bytes>
    void
    gather(const std::vector<unsigned int> &index, const char *data, char *packed)
    {
      for (const unsigned int i : index)
        {
          std::memcpy(packed, data + i * bytes, bytes);
          packed += bytes;
        }
    }

    void
    gather(const std::vector<unsigned int> &index, const char *data, char *packed, const std::size_t bytes)
    {
      switch (bytes) // copies of known length are much faster
        {
          case 8:
            return gather<8>(index, data, packed);
          case 16:
            return gather<16>(index, data, packed);
          case 24:
            return gather<24>(index, data, packed);
          default:
            for (const unsigned int i : index)
              {
                std::memcpy(packed, data + i * bytes, bytes);
                packed += bytes;
              }
        }
    }

    int
    message_size(const std::size_t n, const std::size_t bytes)
    {
      AssertThrow(n * bytes <= static_cast<std::size_t>(std::numeric_limits<int>::max()),
                  dealii::ExcMessage("A message between two ranks has more than 2 GB: use more ranks."));
      return static_cast<int>(n * bytes);
    }
  } // namespace

  Exchange::Exchange(MPI_Comm comm)
    : comm(comm)
  {}

  void
  Exchange::clear()
  {
    partners.clear();
    index.clear();
    n_coming = 0;
  }

  void
  Exchange::reinit(const std::vector<std::vector<unsigned int>> &send, const unsigned int first)
  {
    clear();
    this->first = first;
    std::vector<unsigned int> n_going(send.size()), n_from(send.size());
    for (unsigned int r = 0; r < send.size(); ++r)
      n_going[r] = send[r].size();
    MPI_Alltoall(n_going.data(), 1, MPI_UNSIGNED, n_from.data(), 1, MPI_UNSIGNED, comm);
    for (unsigned int r = 0; r < send.size(); ++r)
      {
        if (n_going[r] + n_from[r] > 0)
          partners.push_back(
            {static_cast<int>(r), static_cast<unsigned int>(index.size()), n_going[r], n_coming, n_from[r]});
        index.insert(index.end(), send[r].begin(), send[r].end());
        n_coming += n_from[r];
      }
    requests.reserve(2 * partners.size());
  }

  void
  Exchange::copy_bytes(char *data, const std::size_t bytes) const
  {
    if (packed.size() < index.size() * bytes)
      packed.resize(index.size() * bytes);
    gather(index, data, packed.data(), bytes);
    transfer(packed.data(), data + first * bytes, bytes);
  }

  void
  Exchange::transfer(const char *packed, char *coming, const std::size_t bytes) const
  {
    const int me = dealii::Utilities::MPI::this_mpi_process(comm);
    requests.clear();
    for (const Partner &p : partners)
      if (p.rank != me && p.n_coming > 0)
        {
          requests.emplace_back();
          MPI_Irecv(coming + p.coming * bytes, message_size(p.n_coming, bytes), MPI_BYTE, p.rank, tag, comm,
                    &requests.back());
        }
    for (const Partner &p : partners)
      if (p.rank == me)
        std::memcpy(coming + p.coming * bytes, packed + p.going * bytes, p.n_going * bytes);
      else if (p.n_going > 0)
        {
          requests.emplace_back();
          MPI_Isend(packed + p.going * bytes, message_size(p.n_going, bytes), MPI_BYTE, p.rank, tag, comm,
                    &requests.back());
        }
    MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  }
} // namespace Stroma::Particles
