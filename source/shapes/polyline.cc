#include <stroma/base/errors.h>
#include <stroma/base/text.h>
#include <stroma/shapes/polyline.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

namespace Stroma::Shapes
{
  namespace
  {
    std::string
    text_of(const dealii::Point<2> &X)
    {
      return "(" + brief(X[0]) + ", " + brief(X[1]) + ")";
    }

    /// The place that a line without comment tells. @param where how an error calls the line
    dealii::Point<2>
    place_of(const std::string &line, const std::string &where)
    {
      auto spaced = line;
      if (std::count(line.begin(), line.end(), ',') == 1)
        std::replace(spaced.begin(), spaced.end(), ',', ' ');
      std::istringstream words(spaced);
      dealii::Point<2>   place;
      unsigned int       n = 0;
      for (std::string word; words >> word; ++n)
        {
          double     number = 0.;
          const auto end    = word.data() + word.size();
          const auto read   = std::from_chars(word.data(), end, number);
          if (read.ec != std::errc() || read.ptr != end || !std::isfinite(number))
            throw UserError(where + ": '" + shown(word) + "' stands where a number should");
          if (n < 2)
            place[n] = number;
        }
      if (n != 2)
        throw UserError(where + ": this line has " + counted(n, "number") + "; a place is 'x y' or 'x, y'");
      return place;
    }
  } // namespace

  std::vector<dealii::Point<2>>
  read_polyline(const std::string &text)
  {
    std::vector<dealii::Point<2>> places;
    std::istringstream            lines(text);
    std::string                   line;
    for (std::size_t n = 1; std::getline(lines, line); ++n)
      if (const auto place = trim(line.substr(0, line.find('#'))); !place.empty())
        places.push_back(place_of(place, "line " + std::to_string(n)));
    if (places.size() < 4)
      throw UserError("a closed polyline has at least three places and the first again, this one has " +
                      std::to_string(places.size()));
    if (places.front() != places.back())
      throw UserError("the polyline is open: it begins at " + text_of(places.front()) + " and ends at " +
                      text_of(places.back()) + "; let it end where it begins");
    places.pop_back();
    return places;
  }
} // namespace Stroma::Shapes
