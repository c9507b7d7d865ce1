#include <stroma/output/hdf5_handle.h>

namespace Stroma::Output
{
  namespace
  {
    /// Called for the innermost error of a stack first; returns 1 to see no other.
    herr_t
    take_description(unsigned int, const H5E_error2_t *error, void *text)
    {
      if (error->desc)
        *static_cast<std::string *>(text) = error->desc;
      return 1;
    }
  } // namespace

  Hdf5Errors::Hdf5Errors()
  {
    H5Eget_auto2(H5E_DEFAULT, &old_function, &old_data);
    H5Eset_auto2(H5E_DEFAULT, &remember, this);
  }

  Hdf5Errors::~Hdf5Errors()
  {
    H5Eset_auto2(H5E_DEFAULT, old_function, old_data);
  }

  herr_t
  Hdf5Errors::remember(const hid_t stack, void *errors)
  {
    std::string &text = static_cast<Hdf5Errors *>(errors)->text;
    if (text.empty())
      H5Ewalk2(stack, H5E_WALK_UPWARD, &take_description, &text);
    return 0;
  }
} // namespace Stroma::Output
