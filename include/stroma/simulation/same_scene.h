#pragma once

#include <stroma/base/parameters.h>
#include <stroma/output/archive.h>

namespace Stroma
{
  /// The entries of a scene as a text for archives: a line each, "name<tab>value<tab>given" or "default".
  /// @param images name and checksum of what the files of bodies hold (images, surfaces), see file_checksums(): they are taken
  /// for given entries
  std::string scene_text(const Parameters &parameters, const ParameterFile &file,
                         const std::map<std::string, std::string> &images);

  /**
   * Throws UserError, beginning with @p path, if the archive's scene or version is another one than that of @p parameters.
   * What is written, units, title, the end of time and the paths of images and surfaces may differ; and so may a default that
   * neither file gives, since it follows from others (the steps from the end). Collective.
   * @param advice what to do, after a semicolon
   * @param free_section a top-level section whose entries may differ too
   */
  void check_same_scene(const Output::ArchiveReader &archive, const std::string &path, const Parameters &parameters,
                        const ParameterFile &file, const std::map<std::string, std::string> &images,
                        const std::string &advice, const std::string &free_section = "Output");
} // namespace Stroma
