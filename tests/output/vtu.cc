#include <stroma/output/vtu.h>

#include <gtest/gtest.h>

#include <sstream>

using namespace Stroma::Output;

TEST(Vtu, NamesOfMaterialsAreFieldData)
{
  PointBlock block;
  block.positions = {0.f, 0.f, 0.f};
  block.values    = {{1.f}};
  std::ostringstream out, without;
  write_vtu(out, {{"material", 1}}, block, {{"positions", {}}, {"material_names", {"gel", "b"}}});
  const auto text = out.str();
  EXPECT_NE(text.find("<FieldData>\n<DataArray type=\"String\" Name=\"material_names\" NumberOfTuples=\"2\" "
                      "format=\"ascii\">\n103 101 108 0\n98 0\n</DataArray>\n</FieldData>\n<Piece"),
            std::string::npos);
  write_vtu(without, {{"material", 1}}, block);
  EXPECT_EQ(without.str().find("FieldData"), std::string::npos);
}
