#pragma once

namespace Stroma::Memory
{
  /// Says what results and files of the run that is read will take besides what its method takes [bytes, of all ranks]:
  /// require() counts it along.
  void reserve_for_results(double bytes);

  double reserved_for_results();
} // namespace Stroma::Memory
