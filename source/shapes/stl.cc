#include <stroma/base/errors.h>
#include <stroma/base/text.h>
#include <stroma/shapes/stl.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <map>

namespace Stroma::Shapes
{
  namespace
  {
    constexpr std::size_t header       = 80,
                          per_triangle = 50; ///< bytes of a binary file; after the header a count of 4 bytes

    /// Collects triangles; corners at the same place become one, triangles with two such corners none.
    class Collector
    {
    public:
      void
      add(const std::array<std::array<float, 3>, 3> &triangle)
      {
        std::array<unsigned int, 3> corners;
        for (unsigned int i = 0; i < 3; ++i)
          {
            const auto &x = triangle[i];
            if (!(std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2])))
              throw UserError("a corner of triangle " + grouped(n + 1) + " is not finite");
            const auto found = names.emplace(std::array<float, 3>{{x[0] + 0.f, x[1] + 0.f, x[2] + 0.f}}, names.size());
            if (found.second)
              result.vertices.emplace_back(x[0], x[1], x[2]);
            corners[i] = found.first->second;
          }
        ++n;
        if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0])
          result.corners.push_back(corners);
      }

      Triangles result;

    private:
      std::map<std::array<float, 3>, unsigned int> names;
      std::size_t                                  n = 0;
    };

    /// The words of an ASCII file and the lines that they stand in.
    class Words
    {
    public:
      explicit Words(const std::string &text)
        : next_letter(text.data())
        , end(text.data() + text.size())
      {}

      /// The next word in small letters; empty at the end.
      std::string
      next()
      {
        const auto is_space = [](const char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; };
        for (; next_letter != end && is_space(*next_letter); ++next_letter)
          line += *next_letter == '\n';
        std::string word;
        for (; next_letter != end && !is_space(*next_letter); ++next_letter)
          word += std::tolower(static_cast<unsigned char>(*next_letter));
        return word;
      }

      /// Goes on to the next line: the rest of this one is a name.
      void
      skip_line()
      {
        next_letter = std::find(next_letter, end, '\n');
      }

      void
      expect(const std::string &wanted)
      {
        refuse_unless(wanted, next(), [&](const std::string &word) { return word == wanted; });
      }

      float
      number()
      {
        float value = 0;
        refuse_unless("a number", next(), [&](const std::string &word) {
          const char *first = word.data() + (word[0] == '+'), *last = word.data() + word.size();
          const auto  parsed = std::from_chars(first, last, value);
          return parsed.ec == std::errc() && parsed.ptr == last;
        });
        return value;
      }

      template <typename Right>
      void
      refuse_unless(const std::string &wanted, const std::string &word, const Right &is_right)
      {
        if (word.empty())
          throw UserError("the file ends where " + wanted + " should follow; it is truncated");
        if (!is_right(word))
          throw UserError("line " + std::to_string(line) + ": '" + shown(word) + "' stands where " + wanted +
                          " should; this is no STL");
      }

    private:
      const char *next_letter, *end;
      std::size_t line = 1;
    };

    std::array<std::array<float, 3>, 3>
    read_facet(Words &words)
    {
      words.expect("normal");
      for (unsigned int d = 0; d < 3; ++d)
        words.number();
      words.expect("outer");
      words.expect("loop");
      std::array<std::array<float, 3>, 3> corners;
      for (auto &corner : corners)
        {
          words.expect("vertex");
          for (float &x : corner)
            x = words.number();
        }
      words.expect("endloop");
      words.expect("endfacet");
      return corners;
    }

    Triangles
    read_ascii(const std::string &text)
    {
      Words     words(text);
      Collector triangles;
      for (std::string solid = words.next(); !solid.empty(); solid = words.next()) // often one
        {
          words.refuse_unless("'solid'", solid, [](const std::string &w) { return w == "solid"; });
          words.skip_line();
          std::string word = words.next();
          for (; word != "endsolid"; word = words.next())
            {
              words.refuse_unless("'facet' or 'endsolid'", word, [](const std::string &w) { return w == "facet"; });
              triangles.add(read_facet(words));
            }
          words.skip_line();
        }
      return triangles.result;
    }

    Triangles
    read_binary(const std::string &bytes, const std::size_t n)
    {
      Collector triangles;
      for (std::size_t i = 0; i < n; ++i)
        {
          // The normal, the corners, two bytes that mean nothing here.
          std::array<std::array<float, 3>, 3> triangle;
          std::memcpy(triangle.data(), bytes.data() + header + 4 + i * per_triangle + 12, sizeof(triangle));
          triangles.add(triangle);
        }
      return triangles.result;
    }
  } // namespace

  Triangles
  read_stl(const std::string &bytes)
  {
    std::uint32_t n = 0; // numbers are little-endian, as the machines that we build for
    if (bytes.size() >= header + 4)
      std::memcpy(&n, bytes.data() + header, 4);
    const std::size_t wanted = header + 4 + n * per_triangle;
    if (bytes.size() >= header + 4 && bytes.size() == wanted)
      return read_binary(bytes, n);
    const std::size_t first = bytes.find_first_not_of(" \t\r\n");
    if (first != std::string::npos && bytes.compare(first, 5, "solid") == 0 && bytes.find('\0') == std::string::npos)
      return read_ascii(bytes);
    if (bytes.size() < header + 4)
      throw UserError("a file of " + counted(bytes.size(), "byte") + " is no STL");
    throw UserError("a binary STL of " + counted(n, "triangle") + " has " + counted(wanted, "byte") +
                    ", this file has " + grouped(bytes.size()) + "; it is truncated, or no STL");
  }
} // namespace Stroma::Shapes
