"""Words from right to left, which a window shows and the tests look for."""

# "Look at both objects and judge", and "look at both objects"
HEBREW = ("הביטו", "בשני", "העצמים", "ושפטו")
ARABIC = ("انظروا", "إلى", "الجسمين")
