"""Material cards: laws with their constants, effects, and parts beside a law."""

from factory.materials.cards import LAWS, Card, card_names, card_path, check_law, load_card, material_of

__all__ = ["LAWS", "Card", "card_names", "card_path", "check_law", "load_card", "material_of"]
