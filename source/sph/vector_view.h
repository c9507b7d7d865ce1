#pragma once

#include <stroma/base/types.h>

namespace Stroma::Sph
{
  /// The owned entries of a vector over free particles as one @p Value (a tensor, or an array of them) each.
  template <typename Value>
  Value *
  view(Vector &x)
  {
    return reinterpret_cast<Value *>(x.begin());
  }

  template <typename Value>
  const Value *
  view(const Vector &x)
  {
    return reinterpret_cast<const Value *>(x.begin());
  }
} // namespace Stroma::Sph
