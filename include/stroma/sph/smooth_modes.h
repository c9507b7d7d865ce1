#pragma once

#include <stroma/particles/neighbours.h>

#include <Eigen/SparseCholesky>

#include <array>
#include <vector>

namespace Stroma::Sph
{
  using namespace Particles;

  /**
   * Smooth changes of area vectors, which conjugate gradients with block Jacobi take longest to find. For any field f the unknowns
   *   phi = f,     Psi = grad f/2
   * change area vectors by third derivatives of f alone, as f_i - f_j + (grad f_i + grad f_j).r/2 is the error of a trapezoidal rule:
   * eigenvalues fall with the sixth power of the wave number. Here f is a sum of quadratic B-splines on a grid of two spacings (in space three)
   * or more, an own sum for each component, and the normal equations of their factors are solved directly, on all ranks alike: together
   * with block Jacobi on the particles a preconditioner of two levels (additive Schwarz). On 40^2 particles between
   * four walls of facets a twentieth of the iterations is left.
   */
  template <int dim>
  class SmoothModes
  {
  public:
    using Basis   = dealii::Tensor<1, dim + 1>; ///< what multiplies phi over the spacing, and Psi, in one component
    using Unknown = std::array<Basis, dim>;

    /// @param spacing [m] @param reach of pairs [m] @param n_left_out leading entries of Basis that a particle does not have, of all
    /// particles and ghosts. Collective.
    SmoothModes(const Neighbours<dim> &neighbours, const ParticleSet<dim> &particles, double spacing, double reach,
                const std::vector<std::uint8_t> &n_left_out);

    using Block = dealii::Tensor<2, dim + 1>;

    /// Adds @p block, of particle @p i, to the equations of all components.
    void add(unsigned int i, const Block &block);
    /// Adds weight own (x) other, what the unknowns of j do in row @p i, likewise.
    void add(unsigned int i, unsigned int j, double weight, const Basis &own, const Basis &other);
    /// Adds weight own (x) own to the equations of component @p k.
    void add_to_component(unsigned int k, unsigned int i, double weight, const Basis &own);

    /// Once all is added. Collective.
    void factorise();

    /// y += what the modes make of x, both of free particles. Collective.
    void add_solution(Unknown *y, const Unknown *x) const;

  private:
    static constexpr unsigned int n_splines = dim == 2 ? 9 : 27; ///< at a place
    static constexpr int          far       = 4;                 ///< between nodes of a pair's particles, at most
    static constexpr int          n_along   = 2 * far + 1;       ///< nodes around one, along an axis
    static constexpr unsigned int n_offsets = dim == 2 ? 81 : 729;

    using Node    = std::array<int, dim>;
    using Factors = std::array<double, n_splines>;

    void         lay_grid(const ParticleSet<dim> &particles, double least);
    void         set_splines(const dealii::Point<dim> &x, unsigned int i, unsigned int n_left_out);
    unsigned int index_of(const Node &node) const;
    Node         node_at(Node node, unsigned int offset) const;
    void         add_products(std::vector<double> &sums, unsigned int i, unsigned int j, const Factors &left,
                              const Factors &right) const;
    void         factorise(unsigned int k, const std::vector<double> &sums);

    const Neighbours<dim>                            &neighbours;
    const double                                      spacing;
    dealii::Point<dim>                                lower;
    std::array<double, dim>                           size{}; ///< of cells [m]
    std::array<int, dim>                              n_cells{};
    unsigned int                                      n_nodes = 1;
    std::vector<Node>                                 first; ///< cell of each particle, which is the first of its nodes
    std::vector<std::array<std::uint32_t, n_splines>> nodes; ///< of each particle, as they are numbered
    std::vector<std::array<Basis, n_splines>>         splines; ///< of each particle: f over the spacing, and grad f/2
    std::vector<double>                  of_all; ///< sums for each node and those around it: of all components
    std::array<std::vector<double>, dim> of_one; ///< and of each one besides
    std::array<Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>, dim> factors;
    std::array<Eigen::VectorXd, dim>                                    scale; ///< of the nodes: makes the diagonal 1
  };
} // namespace Stroma::Sph
