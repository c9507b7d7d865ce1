#include <stroma/base/node_copy.h>

#include <deal.II/base/mpi.h>

#include <boost/interprocess/mapped_region.hpp>
#include <boost/interprocess/shared_memory_object.hpp>

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string>

namespace Stroma
{
  namespace
  {
    namespace MPI = dealii::Utilities::MPI;
    namespace ipc = boost::interprocess;

    /// Shared memory that is given what there is not ends the program when it is written to.
    bool
    has_room(const std::size_t n)
    {
      std::error_code code;
      const auto      space = std::filesystem::space("/dev/shm", code);
      return !code && n < space.available / 2;
    }

    /// Makes shared memory of a name that no other process has, or maps what another rank made.
    ipc::mapped_region
    map(std::string &name, const std::vector<std::uint8_t> &bytes)
    {
      if (!name.empty())
        return {ipc::shared_memory_object(ipc::open_only, name.c_str(), ipc::read_only), ipc::read_only};
      static unsigned int       n_made = 0;
      const std::string         next   = "stroma-" + std::to_string(getpid()) + "-" + std::to_string(n_made++);
      ipc::shared_memory_object memory(ipc::create_only, next.c_str(), ipc::read_write);
      name = next; // from here on it is to be removed
      memory.truncate(bytes.size());
      ipc::mapped_region region(memory, ipc::read_write);
      std::copy(bytes.begin(), bytes.end(), static_cast<std::uint8_t *>(region.get_address()));
      return region;
    }

    /// What the first rank of the node has, shared; empty where that is not possible. Collective on the node.
    std::shared_ptr<const std::uint8_t>
    shared(const std::vector<std::uint8_t> &bytes, const MPI_Comm node)
    {
      const bool         is_first = MPI::this_mpi_process(node) == 0;
      ipc::mapped_region region;
      std::string        name;
      bool               done = true;
      const auto         act  = [&] {
        try
          {
            region = map(name, bytes);
          }
        catch (const ipc::interprocess_exception &)
          {
            done = false;
          }
      };
      if (is_first && !bytes.empty() && has_room(bytes.size()))
        act();
      name = MPI::broadcast(node, name, 0);
      if (name.empty())
        return nullptr;
      if (!is_first)
        act();
      done = MPI::min(done ? 1 : 0, node) == 1;
      if (is_first)
        ipc::shared_memory_object::remove(name.c_str()); // it stays for those who have mapped it
      if (!done)
        return nullptr;
      const auto kept = std::make_shared<ipc::mapped_region>(std::move(region));
      return {kept, static_cast<const std::uint8_t *>(kept->get_address())};
    }
  } // namespace

  std::shared_ptr<const std::uint8_t>
  one_copy_a_node(std::vector<std::uint8_t> bytes, const MPI_Comm comm)
  {
    const int rank = MPI::this_mpi_process(comm);
    MPI_Comm  node, firsts;
    MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, rank, MPI_INFO_NULL, &node);
    const bool is_first = MPI::this_mpi_process(node) == 0;
    MPI_Comm_split(comm, is_first ? 0 : 1, rank, &firsts); // rank 0 is the first of both
    const auto send = [&](const MPI_Comm to) {
      bytes.resize(MPI::broadcast(to, bytes.size(), 0));
      MPI::broadcast(bytes.data(), bytes.size(), 0, to); // MPI counts in int: this one sends what is larger in parts
    };
    if (is_first)
      send(firsts);
    auto copy = MPI::n_mpi_processes(node) > 1 ? shared(bytes, node) : nullptr;
    if (!copy)
      {
        send(node);
        const auto kept = std::make_shared<std::vector<std::uint8_t>>(std::move(bytes));
        copy            = {kept, kept->data()};
      }
    MPI_Comm_free(&node);
    MPI_Comm_free(&firsts);
    return copy;
  }
} // namespace Stroma
