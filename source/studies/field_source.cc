#include <stroma/base/log.h>
#include <stroma/base/text.h>
#include <stroma/studies/field_source.h>
#include <stroma/studies/reference_file.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace Stroma::Studies
{
  namespace fs = std::filesystem;

  std::vector<std::string>
  names_of(const std::vector<Output::Field> &fields)
  {
    std::vector<std::string> names;
    for (const auto &field : fields)
      names.push_back(field.name);
    return names;
  }

  unsigned int
  n_components(FieldSource &source, const std::vector<std::string> &fields)
  {
    unsigned int n = 0;
    for (const auto &known : source.fields())
      for (const auto &name : fields)
        n += known.name == name ? known.components : 0;
    return n;
  }

  RunSource::RunSource(const std::string &folder, const MPI_Comm comm)
    : folder(folder)
    , comm(comm)
    , run(folder, comm)
    , geometry(SceneGeometry::of(run))
    , known(Output::StateFields(run.dimension(), run.facts().sampled_fields).list())
  {}

  const Output::StateView &
  RunSource::at(const double time, const bool with_gradients)
  {
    const auto  &times   = run.times();
    const double nearest = *std::min_element(times.begin(), times.end(), [&](const double a, const double b) {
      return std::abs(a - time) < std::abs(b - time);
    });
    if (!view || nearest != loaded_time || (with_gradients && !has_gradients))
      {
        view.reset();
        if (nearest != loaded_time || !method)
          method = &run.at(nearest);
        view          = method->state(with_gradients);
        has_gradients = with_gradients;
        loaded_time   = nearest;
      }
    return *view;
  }

  void
  RunSource::sample(const std::vector<std::string> &fields, const double time, PlaceSet &places)
  {
    at(time, false).sample({run.dimension(), fields}, places.samples);
  }

  Output::Samples
  RunSource::own_samples(const std::vector<std::string> &fields, const double time)
  {
    const Output::StateFields asked(run.dimension(), fields);
    return Output::own_samples(at(time, asked.has_gradients()), asked);
  }

  void
  RunSource::let_go()
  {
    view.reset();
    method = nullptr;
    run.let_go();
  }

  ExactSource::ExactSource(RunSource &run)
    : run(run)
  {
    for (const auto &field : run.fields())
      if (run.run.has_exact(field.name))
        known.push_back(field);
    if (known.empty())
      throw UserError(run.folder,
                      "the scene of this run has no exact solution; give section 'Exact solution' an entry, or "
                      "compare with a run or a stored reference");
  }

  void
  ExactSource::sample(const std::vector<std::string> &fields, const double time, PlaceSet &places)
  {
    auto              &samples = places.samples;
    const unsigned int width   = n_components(*this, fields);
    unsigned int       first   = 0;
    samples.values.resize(samples.X.size() * width);
    samples.found.clear();
    for (const auto &name : fields)
      {
        for (std::size_t i = 0; i < samples.X.size(); ++i)
          run.run.exact(name, samples.X[i], time, samples.values.data() + i * width + first);
        first += n_components(*this, {name});
      }
  }

  std::unique_ptr<FieldSource>
  open_source(const std::string &what, RunSource &a, const MPI_Comm comm)
  {
    if (what == "exact")
      return std::make_unique<ExactSource>(a);
    std::unique_ptr<FieldSource> source;
    std::error_code              code;
    if (fs::is_directory(what, code))
      source = std::make_unique<RunSource>(what, comm);
    else if (fs::exists(what, code))
      source = std::make_unique<ReferenceSource>(what, comm);
    else
      throw UserError(shown(what),
                      "there is no such folder or file; give the folder of a run, a reference stored by --save, or "
                      "the word exact");
    const std::string difference = source->frame().difference_from(a.frame());
    if (!difference.empty())
      throw UserError(what, "this is of another scene than run " + a.folder + ": it " + difference);
    const double thickness = source->frame().thickness;
    if (std::abs(thickness / a.frame().thickness - 1.) > 1e-9)
      Log::warning(what + " is " + brief(thickness) + " m thick, run " + a.folder + " " + brief(a.frame().thickness) +
                   " m; fields are compared, but forces are not comparable");
    return source;
  }
} // namespace Stroma::Studies
