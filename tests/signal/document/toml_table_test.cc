#include "document/toml_table.h"

#include "tests/test.h"

namespace rigfit::document::toml_table_test {

TEST(TomlTable, ReadsEveryKindAndFinishesWhenAllIsUsed) {
  auto table = TomlTable::parse(
      "title = \"rig\"\nlength = 2\nmass = 0.5\ncount = 3\nheavy = true\nplace = [1, 2.5, -3]\n"
      "names = [\"a\", \"b\"]\none = \"c\"\nkind = \"cable\"\n"
      "[support]\nstiff = [inf, 1e3]\n[[part]]\nx = 1\n[[part]]\nx = 2\n",
      "rig.toml");
  EXPECT_EQ(table.string("title"), "rig");
  EXPECT_EQ(table.number("length", Bound::positive, "m"), 2);
  EXPECT_EQ(table.number_or("mass", Bound::positive, "kg", 9), 0.5);
  EXPECT_EQ(table.number_or("absent", Bound::positive, "kg", 9), 9);
  EXPECT_EQ(table.integer_or("count", 1, 10, 5), 3);
  EXPECT_TRUE(table.boolean_or("heavy", false));
  EXPECT_THAT(table.numbers("place", 3, 3, Bound::any, "m"), ElementsAre(1, 2.5, -3));
  EXPECT_THAT(table.strings("names"), ElementsAre("a", "b"));
  EXPECT_THAT(table.strings("one"), ElementsAre("c"));
  EXPECT_EQ(table.choice_or("kind", {"cable", "beam"}, "beam"), "cable");
  auto support = table.table("support");
  EXPECT_EQ(support.numbers("stiff", 2, 2, Bound::not_negative, "N/m", true)[1], 1000);
  EXPECT_NO_THROW(support.finish());
  auto parts = table.tables_or_empty("part");
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[1].number("x", Bound::any, ""), 2);
  EXPECT_EQ(parts[1].path(), "part[1]");
  EXPECT_THAT(table.keys(), ElementsAre("title", "length", "mass", "count", "heavy", "place",
                                        "names", "one", "kind", "support", "part"));
  EXPECT_NO_THROW(table.finish());
}

struct Mistake {
  const char* text;
  std::function<void(TomlTable&)> read;
  long line;
  const char* message;  ///< a part of what must be said
};

TEST(TomlTable, SaysWhatIsWrongWhereAndWhatToDo) {
  const std::vector<Mistake> mistakes = {
      {"[s]\ny = 0.0\n", [](TomlTable& t) { t.table("s").number("x", Bound::positive, "kg"); }, 1,
       "s.x: is missing"},
      {"x = 11\n", [](TomlTable& t) { t.integer_or("x", 1, 9, 1); }, 1, "from 1 to 9, got 11"},
      {"x = \"yes\"\n", [](TomlTable& t) { t.boolean_or("x", true); }, 1, "true or false"},
      {"x = [1, \"a\"]\n", [](TomlTable& t) { t.numbers("x", 2, 2, Bound::any, "m"); }, 1,
       "value 2 must be a number"},
      {"x = [1]\n", [](TomlTable& t) { t.strings("x"); }, 1, "value 1 must be a string"},
      {"x = 1\n", [](TomlTable& t) { t.table("x"); }, 1, "must be a table"},
      {"x = [1]\n", [](TomlTable& t) { t.tables_or_empty("x"); }, 1, "must be a table, got 1"},
  };
  for (const auto& mistake : mistakes) {
    SCOPED_TRACE(mistake.text);
    try {
      auto table = TomlTable::parse(mistake.text, "rig.toml");
      mistake.read(table);
      ADD_FAILURE() << "was accepted";
    } catch (const DocumentError& error) {
      EXPECT_EQ(error.where().file, "rig.toml");
      EXPECT_EQ(error.where().line, mistake.line);
      EXPECT_THAT(error.what(), HasSubstr(mistake.message));
      EXPECT_FALSE(error.remedy().empty());
    }
  }
}

TEST(TomlTable, NearestWordNeedsToBeNear) {
  EXPECT_EQ(nearest_word("tensoin", {"tension", "torsion"}), "tension");
  EXPECT_EQ(nearest_word("ei", {"EA", "EI"}), "EI");
  EXPECT_FALSE(nearest_word("zebra", {"mass", "name"}).has_value());
  EXPECT_FALSE(nearest_word("x", {"y"}).has_value());
}

}  // namespace rigfit::document::toml_table_test
