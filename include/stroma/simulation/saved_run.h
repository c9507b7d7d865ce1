#pragma once

#include <stroma/base/parameter_file.h>
#include <stroma/scene/scene.h>
#include <stroma/simulation/method.h>

#include <mpi.h>

#include <memory>
#include <string>
#include <vector>

namespace Stroma
{
  /// File of the state that the run in @p folder keeps after @p step steps; makes its folder. Throws OutputError. Collective.
  std::string state_path(const std::string &folder, unsigned int step, MPI_Comm comm);

  /// A run as it was at the times at which it kept its state ('Output/Keep states').
  class SavedRun
  {
  public:
    /// Reads the scene from folder/parameters.prm and the times of its states. Throws UserError if there are none. Collective.
    SavedRun(const std::string &folder, MPI_Comm comm);
    ~SavedRun();

    const std::string &
    folder() const
    {
      return path;
    }
    /// Times of the kept states, ascending [s].
    const std::vector<double> &
    times() const
    {
      return state_times;
    }

    /// The method with its state at @p time, one of times(). Valid until the next call, or let_go(). Collective.
    Method &at(double time);

    /// Frees the memory of the state. Collective.
    void let_go();

    unsigned int
    dimension() const
    {
      return dim;
    }
    /// The scene, of this dimension().
    template <int dimension>
    const Scene<dimension> &scene() const;
    const MethodFacts      &facts() const;
    /// Whether the scene's section 'Exact solution' gives this field (with its unit).
    bool has_exact(const std::string &field) const;
    /// Its components at a place, gradients by central differences.
    void exact(const std::string &field, const Output::Place &X, double time, double *values) const;

  private:
    struct Contents;
    template <int dim>
    struct ContentsIn;

    std::string               path;
    MPI_Comm                  comm;
    ParameterFile             parameters;
    unsigned int              dim;
    std::vector<double>       state_times;
    std::vector<std::string>  state_files;
    std::unique_ptr<Contents> contents;
  };
} // namespace Stroma
