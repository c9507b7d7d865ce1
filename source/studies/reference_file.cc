#include <stroma/base/text.h>
#include <stroma/output/archive.h>
#include <stroma/output/collective.h>
#include <stroma/studies/reference_file.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

namespace Stroma::Studies
{
  namespace
  {
    const std::string kind = "Stroma reference 1";

    std::string
    lines(const std::vector<std::string> &texts)
    {
      std::string all;
      for (const auto &text : texts)
        all += text + '\n';
      return all;
    }

    std::vector<std::string>
    from_lines(const std::string &all)
    {
      std::vector<std::string> texts;
      std::istringstream       in(all);
      for (std::string line; std::getline(in, line);)
        texts.push_back(line);
      return texts;
    }

    /// Whether a file is a reference. Collective over @p comm.
    bool
    is_reference(const std::string &path, const MPI_Comm comm)
    {
      try
        {
          return Output::ArchiveReader(path, comm).attribute_string("kind") == kind;
        }
      catch (const UserError &)
        {
          return false;
        }
    }

    /// The whole of a small array on all ranks.
    std::vector<double>
    whole(const Output::ArchiveReader &archive, const std::string &name, const MPI_Comm comm)
    {
      return Output::gather_all(archive.read_double(name), comm);
    }

    std::string
    group_name(const std::size_t time, const std::size_t set)
    {
      return "time " + std::to_string(time) + "/places " + std::to_string(set);
    }

    void
    write_places(Output::ArchiveWriter &archive, const std::string &group, const Output::Samples &samples)
    {
      std::vector<double> X, material(samples.material.begin(), samples.material.end());
      for (const auto &place : samples.X)
        X.insert(X.end(), place.begin(), place.end());
      archive.write(group + "/X", dealii::make_array_view(X));
      archive.write(group + "/weight", dealii::make_array_view(samples.weight));
      archive.write(group + "/material", dealii::make_array_view(material));
    }

    /// This rank's share.
    Output::Samples
    read_places(const Output::ArchiveReader &archive, const std::string &group)
    {
      Output::Samples samples;
      const auto      X        = archive.read_double(group + "/X", 3);
      const auto      material = archive.read_double(group + "/material");
      samples.weight           = archive.read_double(group + "/weight");
      samples.material.assign(material.begin(), material.end());
      for (std::size_t i = 0; i + 2 < X.size(); i += 3)
        samples.X.push_back({{X[i], X[i + 1], X[i + 2]}});
      return samples;
    }
  } // namespace

  void
  check_reference_target(const std::string &path, const MPI_Comm comm)
  {
    on_root(comm, [&] {
      namespace fs = std::filesystem;
      std::error_code code;
      const fs::path  parent = fs::path(path).parent_path();
      if (!parent.empty() && !fs::is_directory(parent, code))
        throw UserError("--save " + path, "the folder " + parent.string() + " does not exist; make it first");
      if (fs::exists(path, code) && !is_reference(path, MPI_COMM_SELF))
        throw UserError("--save " + path,
                        "the file exists and is no reference, so it is not replaced; give another name");
    });
  }

  void
  write_reference(const std::string &path, const Comparison &comparison, const MPI_Comm comm)
  {
    const auto           &kept = comparison.kept;
    Output::ArchiveWriter archive(path, comm);
    archive.attribute("kind", kind);
    archive.attribute("title", comparison.frame.title);
    archive.attribute("source", comparison.b);
    archive.attribute("dimension", std::uint64_t(comparison.frame.dimension));
    archive.attribute("thickness", comparison.frame.thickness);
    archive.attribute("materials", lines(comparison.frame.materials));
    std::vector<double> box(comparison.frame.lower.begin(), comparison.frame.lower.end()), components;
    box.insert(box.end(), comparison.frame.upper.begin(), comparison.frame.upper.end());
    for (const auto &field : kept.fields)
      components.push_back(field.components);
    const auto write_small = [&](const std::string &name, const std::vector<double> &values) { // once, by rank 0
      const bool is_root = dealii::Utilities::MPI::this_mpi_process(comm) == 0;
      archive.write(name, dealii::ArrayView<const double>(values.data(), is_root ? values.size() : 0));
    };
    write_small("bodies", box);
    write_small("times", comparison.times);
    archive.attribute("fields", lines(names_of(kept.fields)));
    write_small("components", components);
    std::vector<std::string> names;
    for (const auto &set : kept.places.front())
      names.push_back(set.name);
    archive.attribute("places", lines(names));
    for (std::size_t t = 0; t < kept.places.size(); ++t)
      for (std::size_t s = 0; s < names.size(); ++s)
        {
          const auto &samples  = kept.places[t][s].samples;
          const bool  is_other = t == 0 || samples.X != kept.places[0][s].samples.X;
          if (dealii::Utilities::MPI::max(is_other ? 1 : 0, comm) == 1)
            write_places(archive, group_name(t, s), samples);
          archive.write(group_name(t, s) + "/values", dealii::make_array_view(samples.values));
        }
    archive.commit();
  }

  ReferenceSource::ReferenceSource(const std::string &path, const MPI_Comm comm)
    : path(path)
  {
    if (!is_reference(path, comm))
      throw UserError(path, "this is not a reference that 'stroma compare --save' wrote");

    const Output::ArchiveReader archive(path, comm);
    if (const std::string damage = archive.damage(); !damage.empty())
      throw UserError(path, "'" + damage + "' is damaged; store the reference again");
    scene.title     = archive.attribute_string("title");
    scene.dimension = archive.attribute_uint64("dimension");
    scene.thickness = archive.attribute_double("thickness");
    scene.materials = from_lines(archive.attribute_string("materials"));
    const auto box  = whole(archive, "bodies", comm);
    std::copy_n(box.begin(), 3, scene.lower.begin());
    std::copy_n(box.begin() + 3, 3, scene.upper.begin());
    known_times           = whole(archive, "times", comm);
    const auto components = whole(archive, "components", comm);
    const auto names      = from_lines(archive.attribute_string("fields"));
    for (std::size_t f = 0; f < names.size(); ++f)
      known_fields.push_back({names[f], static_cast<unsigned int>(components[f])});
    const auto         sets  = from_lines(archive.attribute_string("places"));
    const unsigned int width = n_components(*this, names);
    for (std::size_t t = 0; t < known_times.size(); ++t)
      {
        places.emplace_back();
        for (std::size_t s = 0; s < sets.size(); ++s)
          {
            const auto group = group_name(t, s);
            // Places that are those of the first time are not stored again.
            places[t].push_back(
              {sets[s], archive.has(group + "/X") ? read_places(archive, group) : places[0][s].samples});
            places[t][s].samples.values = archive.read_double(group + "/values", width);
          }
      }
  }

  std::size_t
  ReferenceSource::nearest(const double time) const
  {
    return std::min_element(known_times.begin(), known_times.end(),
                            [&](const double a, const double b) { return std::abs(a - time) < std::abs(b - time); }) -
           known_times.begin();
  }

  std::vector<PlaceSet>
  ReferenceSource::own_places(const double time) const
  {
    return places[nearest(time)];
  }

  void
  ReferenceSource::sample(const std::vector<std::string> &fields, const double time, PlaceSet &asked)
  {
    const auto &sets   = places[nearest(time)];
    const auto  set    = std::find_if(sets.begin(), sets.end(), [&](const auto &s) { return s.name == asked.name; });
    const auto &stored = set->samples.values;
    const unsigned int stride = n_components(*this, names_of(known_fields)), width = n_components(*this, fields);
    auto              &samples = asked.samples;
    samples.values.assign(samples.X.size() * width, 0.);
    samples.found.assign(samples.X.size(), true);
    unsigned int to = 0;
    for (const auto &name : fields)
      {
        unsigned int from = 0, n = 0;
        for (const auto &known : known_fields)
          {
            if (known.name == name)
              {
                n = known.components;
                break;
              }
            from += known.components;
          }
        for (std::size_t i = 0; i < samples.X.size(); ++i)
          for (unsigned int c = 0; c < n; ++c)
            {
              const double value                 = stored[(asked.first + i) * stride + from + c];
              samples.values[i * width + to + c] = value;
              samples.found[i]                   = samples.found[i] && !std::isnan(value);
            }
        to += n;
      }
  }
} // namespace Stroma::Studies
