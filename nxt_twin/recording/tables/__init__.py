"""Tables as files hold them, before anybody asks what their columns mean: text, Parquet, MAT."""
