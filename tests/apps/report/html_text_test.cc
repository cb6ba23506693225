#include "apps/report/drawing/html_text.h"

#include "apps/report/page/answer.h"
#include "apps/report/page/tables.h"
#include "tests/test.h"

namespace rigfit::apps::html_text_test {

TEST(HtmlText, EscapesMarkupAndMendsBytes) {
  EXPECT_EQ(escaped("a<b>&\"c\" 'd'"), "a&lt;b&gt;&amp;&quot;c&quot; &#39;d&#39;");
  EXPECT_EQ(escaped("N m\xc2\xb2"), "N m\xc2\xb2");
  EXPECT_EQ(escaped("\xb5m"), "µm");                       // Windows-1252
  EXPECT_EQ(escaped(std::string("a\x01z\0", 4)), "a z ");  // control characters
}

TEST(HtmlText, ShowsNumbersWithTheirDigits) {
  EXPECT_EQ(shown(0.25494, 4), "0.2549");
  EXPECT_EQ(shown(-15.5632, 3), "−15.6");
  EXPECT_EQ(shown(221780, 3), "221780");
  EXPECT_EQ(shown(1.5e-6, 2), "1.5e-06");
  EXPECT_EQ(shown(NAN), "–");
  EXPECT_EQ(shown(0), "0");
  EXPECT_EQ(shown_percent(0.01234), "+1.23 %");
  EXPECT_EQ(shown_percent(-0.139), "−13.9 %");
  EXPECT_EQ(shown_percent(1e-9), "0.00 %");
  // The std is never raised to the digits of the value.
  EXPECT_EQ(within_percent(6e-7), "less than 0.001 %");
  EXPECT_EQ(within_percent(0.0041), "0.4 %");
  EXPECT_EQ(within_percent(0.12), "12 %");
}

TEST(ParameterWords, AreNamesAndSymbols) {
  EXPECT_EQ(parameter_words("beam.EI_z"), "Beam bending stiffness EI_z");
  EXPECT_EQ(parameter_words("left cable.damping_ratio"), "Left cable damping ratio ζ");
  EXPECT_EQ(parameter_words("tip.mass"), "Tip mass");
  EXPECT_EQ(parameter_words("cable span"), "Cable span");
  EXPECT_EQ(state_words("beam, as built"), "beam");
  EXPECT_EQ(state_words("200 N"), "200 N");
}

}  // namespace rigfit::apps::html_text_test
