"""The benchmark: makes data, trains, scores, and writes a page. Every step that is done is left out when it is started again."""
