#include "exponential_law.h"

namespace Stroma::Processes
{
  std::shared_ptr<const DegradationLaw>
  degradation_law(Parameters &p)
  {
    enum class Law
    {
      exponential
    };
    Law law = Law::exponential;
    p.add_choice<Law>("Law", law, "how fast, by the distance from the body's surface",
                      {{"exponential", Law::exponential}});
    return std::make_shared<ExponentialLaw>(p);
  }
} // namespace Stroma::Processes
