#include "apps/report/html_text.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rigfit::apps::html_text_test {
namespace {

TEST(HtmlText, EscapesMarkupAndMendsBytes) {
  EXPECT_EQ(escaped("a<b>&\"c\" 'd'"), "a&lt;b&gt;&amp;&quot;c&quot; &#39;d&#39;");
  EXPECT_EQ(escaped("N m\xc2\xb2"), "N m\xc2\xb2");
  EXPECT_EQ(escaped("\xff"), "\xef\xbf\xbd");
  EXPECT_EQ(escaped("\xc2"), "\xef\xbf\xbd");            // cut off
  EXPECT_EQ(escaped(std::string("a\x01z\0", 4)), "az");  // control characters
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
  EXPECT_EQ(shown_estimate(0.49482, 0.00123), "0.4948 ± 0.0012");
  EXPECT_EQ(shown_estimate(221780, 512), "221780 ± 512");
  EXPECT_EQ(shown_estimate(0.5, NAN, 3), "0.500");
}

}  // namespace
}  // namespace rigfit::apps::html_text_test
