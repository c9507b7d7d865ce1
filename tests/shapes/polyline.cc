// Polylines from files: what they tell, and each way in which one is none.

#include "../base/message_of.h"

#include <stroma/shapes/faceted.h>
#include <stroma/shapes/polyline.h>

#include <gtest/gtest.h>

namespace
{
  using namespace Stroma;
  using namespace Stroma::Shapes;

  std::string
  message_of_polyline(const std::string &text)
  {
    return message_of([&] { read_polyline(text); });
  }

  TEST(Polyline, CornersWithBlanksOrCommas)
  {
    const auto corners = read_polyline("# a triangle\n0 0\n\n 2.5e0,0 # right\r\n\t2.5 , 2\n0 0");
    ASSERT_EQ(corners.size(), 3u);
    EXPECT_EQ(corners[1], dealii::Point<2>(2.5, 0.));
    EXPECT_EQ(corners[2], dealii::Point<2>(2.5, 2.));
    EXPECT_NEAR(make_polygon(corners)->volume(), 2.5, 1e-14);
  }

  TEST(Polyline, FilesThatAreNone)
  {
    EXPECT_EQ(message_of_polyline(""),
              "a closed polyline has at least three places and the first again, this one has 0");
    EXPECT_EQ(message_of_polyline("0 0\n1 0\n0 0\n"),
              "a closed polyline has at least three places and the first again, this one has 3");
    EXPECT_EQ(message_of_polyline("0 0\n1 0\n1 1\n0 1\n"),
              "the polyline is open: it begins at (0, 0) and ends at (0, 1); let it end where it begins");
    EXPECT_EQ(message_of_polyline("0 0\n\n1 x\n"), "line 3: 'x' stands where a number should");
    EXPECT_EQ(message_of_polyline("0 0\n1 nan\n"), "line 2: 'nan' stands where a number should");
    EXPECT_EQ(message_of_polyline("0 0\n1,5 2,5\n"), "line 2: '1,5' stands where a number should");
    EXPECT_EQ(message_of_polyline("0 0 0\n"), "line 1: this line has 3 numbers; a place is 'x y' or 'x, y'");
    EXPECT_EQ(message_of_polyline("7\n"), "line 1: this line has 1 number; a place is 'x y' or 'x, y'");
  }
} // namespace
