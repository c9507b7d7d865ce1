#include <stroma/base/text.h>
#include <stroma/grid/free_parts.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <limits>

namespace Stroma
{
  template <int dim>
  FreeParts<dim>::FreeParts(const Scene<dim> &scene, const ConnectedParts<dim> &parts, const unsigned int n_inclusions)
    : motions(scene, parts.size() + n_inclusions)
    , scene(scene)
    , parts(parts)
  {
    Piece empty;
    for (unsigned int d = 0; d < dim; ++d)
      {
        empty.lower[d] = std::numeric_limits<double>::max();
        empty.upper[d] = std::numeric_limits<double>::lowest();
      }
    empty.first_material = std::numeric_limits<double>::max();
    empty.last_material  = -1;
    pieces.assign(parts.size() + n_inclusions, empty);
    for (const auto &joint : parts.joints())
      for (unsigned int c = 0; c < dim; ++c)
        motions.join(joint.first, joint.second, joint.X, c);
    for (unsigned int i = 0; i < parts.size(); ++i)
      if (parts.across_period()[i])
        motions.hold_turns_across_periods(i);
  }

  template <int dim>
  void
  FreeParts<dim>::add_cell(const typename ConnectedParts<dim>::Cell &cell, const unsigned int material)
  {
    Piece &piece = pieces[parts.piece_of(cell)];
    piece.volume += scene.thickness * cell->measure();
    for (const unsigned int v : cell->vertex_indices())
      for (unsigned int d = 0; d < dim; ++d)
        {
          piece.lower[d] = std::min(piece.lower[d], cell->vertex(v)[d]);
          piece.upper[d] = std::max(piece.upper[d], cell->vertex(v)[d]);
        }
    piece.first_material = std::min<double>(piece.first_material, material);
    piece.last_material  = std::max<double>(piece.last_material, material);
  }

  template <int dim>
  void
  FreeParts<dim>::find()
  {
    motions.gather();
    motions.check_whole();
    groups = motions.free_groups();
    if (groups.empty()) // on all ranks
      return;
    std::vector<double> volume, least, most; // of each piece, to be joined over the ranks
    for (const auto &piece : pieces)
      {
        volume.push_back(piece.volume);
        least.push_back(piece.first_material);
        most.push_back(piece.last_material);
        for (unsigned int d = 0; d < dim; ++d)
          {
            least.push_back(piece.lower[d]);
            most.push_back(piece.upper[d]);
          }
      }
    dealii::Utilities::MPI::sum(volume, scene.comm, volume);
    dealii::Utilities::MPI::min(least, scene.comm, least);
    dealii::Utilities::MPI::max(most, scene.comm, most);
    for (std::size_t i = 0; i < pieces.size(); ++i)
      {
        pieces[i].volume         = volume[i];
        pieces[i].first_material = least[i * (dim + 1)];
        pieces[i].last_material  = most[i * (dim + 1)];
        for (unsigned int d = 0; d < dim; ++d)
          {
            pieces[i].lower[d] = least[i * (dim + 1) + 1 + d];
            pieces[i].upper[d] = most[i * (dim + 1) + 1 + d];
          }
        total_volume += pieces[i].volume;
      }
  }

  template <int dim>
  void
  FreeParts<dim>::check_loads(const double                                         end_time,
                              const std::function<void(double, const AddForce &)> &forces_at) const
  {
    if (groups.empty())
      return;
    std::vector<bool> driven(groups.size(), false);
    for (const double part : {0., .37, .71, 1.})
      {
        std::vector<Modes>  forces(pieces.size(), Modes::Zero()); // resultant and moment
        std::vector<double> sizes(pieces.size(), 0.);
        forces_at(part * end_time,
                  [&](const unsigned int piece, const dealii::Point<dim> &X, const dealii::Tensor<1, dim> &force) {
                    for (unsigned int c = 0; c < dim; ++c)
                      forces[piece] += force[c] * motions.row(X, c);
                    sizes[piece] += force.norm();
                  });
        constexpr int n_modes = RigidMotions<dim>::n_modes;
        MPI_Allreduce(MPI_IN_PLACE, forces.data(), n_modes * forces.size(), MPI_DOUBLE, MPI_SUM, scene.comm);
        dealii::Utilities::MPI::sum(sizes, scene.comm, sizes);
        for (std::size_t g = 0; g < groups.size(); ++g)
          driven[g] = driven[g] || is_driven(groups[g], forces, sizes);
      }
    std::vector<const Group *> found;
    for (std::size_t g = 0; g < groups.size(); ++g)
      if (driven[g])
        found.push_back(&groups[g]);
    if (!found.empty())
      refuse(found);
  }

  /// Whether the forces do work in a free motion.
  template <int dim>
  bool
  FreeParts<dim>::is_driven(const Group &group, const std::vector<Modes> &forces,
                            const std::vector<double> &sizes) const
  {
    constexpr unsigned int n_modes = RigidMotions<dim>::n_modes;
    Eigen::VectorXd        work    = Eigen::VectorXd::Zero(group.motions.cols());
    double                 size    = 0;
    for (std::size_t i = 0; i < group.pieces.size(); ++i)
      {
        work += group.motions.middleRows(n_modes * i, n_modes).transpose() * forces[group.pieces[i]];
        size += sizes[group.pieces[i]];
      }
    return work.cwiseAbs().maxCoeff() > 1e-8 * size;
  }

  template <int dim>
  void
  FreeParts<dim>::refuse(const std::vector<const Group *> &driven) const
  {
    throw UserError(scene.loads.front().where, "loads act on " + describe(driven) +
                                                 "; remove such parts from the image or the bodies, hold them by a " +
                                                 "support, or keep the loads off them");
  }

  template <int dim>
  double
  FreeParts<dim>::volume_of(const Group &group) const
  {
    double volume = 0;
    for (const unsigned int piece : group.pieces)
      volume += pieces[piece].volume;
    return volume;
  }

  template <int dim>
  std::string
  FreeParts<dim>::describe(const std::vector<const Group *> &some) const
  {
    double       volume  = 0;
    const Group *largest = some.front();
    unsigned int loose   = 0;
    for (const Group *group : some)
      {
        volume += volume_of(*group);
        loose += group->is_held;
        if (volume_of(*group) > volume_of(*largest))
          largest = group;
      }
    Piece all = pieces[largest->pieces.front()];
    for (const unsigned int i : largest->pieces)
      {
        for (unsigned int d = 0; d < dim; ++d)
          {
            all.lower[d] = std::min(all.lower[d], pieces[i].lower[d]);
            all.upper[d] = std::max(all.upper[d], pieces[i].upper[d]);
          }
        all.first_material = std::min(all.first_material, pieces[i].first_material);
        all.last_material  = std::max(all.last_material, pieces[i].last_material);
      }
    std::string size, place;
    for (unsigned int d = 0; d < dim; ++d)
      {
        size += (d > 0 ? " x " : "") + brief(all.upper[d] - all.lower[d]);
        place += (d > 0 ? ", " : "") + brief(.5 * (all.lower[d] + all.upper[d]));
      }
    const std::string material = all.first_material == all.last_material ?
                                   "of material '" +
                                     scene.material_names[static_cast<unsigned int>(all.first_material)] + "'" :
                                   "of several materials";
    const bool        one      = some.size() == 1;
    const std::string touch    = one ? "touches no support" : "touch no support";
    const std::string free     = one ? "is held too loosely (free to slide, or to turn on a corner or an edge)" :
                                       "are held too loosely (free to slide, or to turn on a corner or an edge)";
    return counted(some.size(), "piece") + " of material (" + brief(100. * volume / total_volume) +
           " % of the volume) that " +
           (loose == 0 ?
              touch :
            loose == some.size() ?
              free :
              "touch no support or are held too loosely (free to slide, or to turn on a corner or an edge)") +
           (one ? ": " : "; the largest is ") + size + " m, around (" + place + ") m, " + material;
  }

  template <int dim>
  std::string
  FreeParts<dim>::words() const
  {
    if (groups.empty())
      return "";
    std::vector<const Group *> all;
    for (const auto &group : groups)
      all.push_back(&group);
    return "there " + std::string(all.size() == 1 ? "is " : "are ") + describe(all) +
           ". No load drives them, so they do no harm";
  }

  template class FreeParts<2>;
  template class FreeParts<3>;
} // namespace Stroma
